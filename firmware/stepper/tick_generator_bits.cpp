// Lattice bits of the tick generator: arm window, lamp trigger, gate, and the power of the laser.
#include "firmware/stepper/tick_generator.hpp"

namespace lamplock::stepper {

void TickGenerator::enter_lattice() {
  const Segment& segment = queue_.at(lattice_.segment);
  may_shine_ = may_shine(segment);
  if (segment.changes != 0 && changes_ != nullptr)
    changes_->grant(segment.changes, segment.start_tick);
  open_window();
}

void TickGenerator::open_window() {
  const Segment& segment = queue_.at(lattice_.segment);
  old_window_ = window_;
  window_ = Window{};
  if (!segment.has_shot()) return;
  const std::uint64_t centre = segment.end_tick() - arm_lead_ticks_;
  window_ = {centre - segment.shot.half_window_ticks, centre + segment.shot.half_window_ticks};
  if (segment.end_tick() <= cut_tick_) window_.cut(cut_tick_);
}

std::uint32_t TickGenerator::limit_by_bits(std::uint64_t tick, std::uint32_t ticks) const {
  ticks = limit_to(window_.on, tick, ticks);
  ticks = limit_to(window_.off, tick, ticks);
  ticks = limit_to(old_window_.off, tick, ticks);
  if (trigger_.period_ticks == 0) return ticks;
  ticks = limit_to(trigger_on_, tick, ticks);
  return limit_to(trigger_on_ + trigger_.width_ticks, tick, ticks);
}

std::uint8_t TickGenerator::bits(std::uint64_t tick) const {
  const auto in = [tick](const Window& w) { return w.on <= tick && tick < w.off; };
  std::uint8_t bits = 0;
  if (in(window_) || in(old_window_)) bits |= arm_bit;
  if (trigger_.period_ticks != 0 && in({trigger_on_, trigger_on_ + trigger_.width_ticks}))
    bits |= trigger_bit;
  if (shines()) bits |= gate_bit;
  return bits;
}

void TickGenerator::pass(Reader& reader, std::uint32_t ticks) {
  if (reader.left == 0) return;
  reader.left -= ticks;
  if (reader.left == 0) ++reader.segment;
}

/// The lattice bits have advanced by n ticks to `tick`.
void TickGenerator::advance_bits(std::uint64_t tick, std::uint32_t ticks) {
  pass(lattice_, ticks);
  if (beam_.active()) beam_.pass(ticks);
  pass(laser_, ticks);
  if (trigger_.period_ticks == 0) return;
  if (trigger_on_ < tick) last_trigger_ = trigger_on_;
  while (trigger_on_ + trigger_.width_ticks <= tick) trigger_on_ += trigger_.period_ticks;
}

/// The laser enters the segment that begins for it at `tick` of the lattice. Returns for how many
/// of these ticks it stays in its segment.
std::uint32_t TickGenerator::limit_by_laser(std::uint64_t tick, std::uint32_t ticks) {
  if (tick < laser_lag_ticks_) return limit_to(laser_lag_ticks_, tick, ticks);
  const std::uint64_t at = tick + laser_.lead - laser_lag_ticks_;
  if (laser_.left == 0) enter_laser(at);
  const std::uint32_t n = limit_by(laser_, at, ticks);
  return beam_.active() ? beam_.limit(n) : n;
}

/// The laser enters the segment that begins at its own `tick`, if there is one.
void TickGenerator::enter_laser(std::uint64_t tick) {
  if (!enter(laser_, tick)) return beam_.leave();
  const Segment& segment = queue_.at(laser_.segment);
  power_axis_ = static_cast<std::int8_t>(power_axis(segment));
  if (segment.shines || beam_.active()) beam_.enter(segment);
}

PowerStretch TickGenerator::power_stretch(std::uint32_t tick) const {
  if (beam_.active()) return beam_.stretch();
  const Segment& s = queue_.at(laser_.segment);
  const std::uint32_t at = tick + laser_.lead - laser_lag_ticks_;
  return power_from(s.power, s.axis[index(power_axis_)],
                    at - static_cast<std::uint32_t>(s.start_tick));
}

/// Up to where the slope of the power changes.
std::uint32_t TickGenerator::limit_by_power(std::uint32_t ticks) const {
  if (!shines()) return ticks;
  const std::uint32_t left = power_stretch(static_cast<std::uint32_t>(tick_)).ticks;
  return left < ticks ? left : ticks;
}

}  // namespace lamplock::stepper
