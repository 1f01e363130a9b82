#include "firmware/stepper/tick_generator.hpp"

namespace lamplock::stepper {
namespace {
constexpr std::uint32_t forever = 0xffffffffu;
}  // namespace

TickGenerator::TickGenerator() { set_position({}); }

void TickGenerator::set_position(const StepPosition& steps) {
  for (int a = 0; a < max_axes; ++a) {
    runs_[index(a)] = Run{};
    runs_[index(a)].run.position_q64 = middle_of_step(steps[index(a)]);
    runs_[index(a)].left = forever;
  }
}

MotionState TickGenerator::state() const {
  if (running_ && left_ == 0) return segment_.end;  // between two segments
  MotionState state;
  state.tick = tick_;
  for (int a = 0; a < max_axes; ++a) {
    const AxisRun& run = runs_[index(a)].run;
    // The rate is the speed in the middle of a tick; the speed at its start is half an A less.
    state.axis[index(a)] = {run.position_q64, run.rate_q62 - run.accel_q62 / 2};
  }
  return state;
}

void TickGenerator::load(const Segment& segment) {
  segment_ = segment;
  running_ = true;
  left_ = segment.ticks;
  old_window_ = window_;
  window_ = Window{};
  if (segment.shot.present) {
    const std::uint64_t centre = segment.end_tick() - arm_lead_ticks_;
    window_ = {centre - segment.shot.half_window_ticks, centre + segment.shot.half_window_ticks};
  }
  for (int a = 0; a < max_axes; ++a) {
    runs_[index(a)].piece = 0;
    next_piece(a);
  }
}

void TickGenerator::replace(const Segment& segment) {
  window_ = Window{};
  load(segment);
  old_window_ = Window{};
}

void TickGenerator::halt() {
  running_ = underrun_ = false;
  window_ = old_window_ = Window{};
  stand();
}

void TickGenerator::stand() {
  for (Run& r : runs_) {
    r.run.rate_q62 = r.run.accel_q62 = 0;
    r.left = forever;
  }
}

void TickGenerator::next_piece(int a) {
  Run& r = runs_[index(a)];
  const AxisProfile& p = segment_.axis[index(a)];
  // Pieces: lead up to its turn, rest of the lead, cruise, tail up to its turn, rest of the tail.
  r.left = 0;
  while (r.left == 0 && r.piece < 5) {
    switch (r.piece++) {
      case 0:
        r.run.accel_q62 = p.lead_accel_q62;
        r.run.rate_q62 = p.speed_q62 + p.lead_accel_q62 / 2;
        r.left = p.lead_turn_ticks != 0 ? p.lead_turn_ticks : p.lead_ticks;
        break;
      case 1:
        if (p.lead_turn_ticks != 0) r.left = p.lead_ticks - p.lead_turn_ticks;
        break;
      case 2:
        r.run.accel_q62 = 0;
        r.run.rate_q62 = p.cruise_speed_q62();
        r.left = p.cruise_ticks;
        break;
      case 3:
        r.run.accel_q62 = p.tail_accel_q62;
        r.run.rate_q62 = p.cruise_speed_q62() + p.tail_accel_q62 / 2;
        r.left = p.tail_turn_ticks != 0 ? p.tail_turn_ticks : p.tail_ticks;
        break;
      default:
        if (p.tail_turn_ticks != 0) r.left = p.tail_ticks - p.tail_turn_ticks;
        break;
    }
  }
  if (r.left == 0) {
    r.run.rate_q62 = r.run.accel_q62 = 0;
    r.left = forever;
  }
}

std::uint32_t TickGenerator::limit_to(std::uint64_t change, std::uint32_t ticks) const {
  return change > tick_ && change - tick_ < ticks ? static_cast<std::uint32_t>(change - tick_)
                                                  : ticks;
}

std::uint32_t TickGenerator::limit_by_bits(std::uint32_t ticks) const {
  ticks = limit_to(window_.on, ticks);
  ticks = limit_to(window_.off, ticks);
  ticks = limit_to(old_window_.off, ticks);
  if (trigger_.period_ticks == 0) return ticks;
  ticks = limit_to(trigger_on_, ticks);
  return limit_to(trigger_on_ + trigger_.width_ticks, ticks);
}

std::uint8_t TickGenerator::bits() const {
  const auto in = [this](const Window& w) { return w.on <= tick_ && tick_ < w.off; };
  std::uint8_t bits = 0;
  if (in(window_) || in(old_window_)) bits |= arm_bit;
  if (trigger_.period_ticks != 0 && in({trigger_on_, trigger_on_ + trigger_.width_ticks}))
    bits |= trigger_bit;
  return bits;
}

void TickGenerator::advance(std::uint32_t ticks) {
  tick_ += ticks;
  for (int a = 0; a < max_axes; ++a) {
    Run& r = runs_[index(a)];
    if (r.run.rate_q62 != 0 || r.run.accel_q62 != 0) {
      r.run.position_q64 = r.run.position_after(ticks);
      r.run.rate_q62 += r.run.accel_q62 * static_cast<std::int64_t>(ticks);
    }
    if (r.left != forever) r.left -= ticks;
  }
  if (trigger_.period_ticks == 0) return;
  if (trigger_on_ < tick_) last_trigger_ = trigger_on_;
  while (trigger_on_ + trigger_.width_ticks <= tick_) trigger_on_ += trigger_.period_ticks;
}

void TickGenerator::fill(SegmentQueue& queue, TickBlock& block, std::uint32_t max_ticks) {
  if (running_ && left_ == 0) {
    const bool follows = !queue.empty() && queue.front().start_tick == tick_;
    if (!follows) {
      if (!segment_.end.at_rest()) underrun_ = true;
      stand();
    }
    running_ = false;
  }
  if (!running_ && !queue.empty() && queue.front().start_tick <= tick_) {
    // Run late, it would arm its shots where the machine is not.
    if (queue.front().start_tick < tick_) {
      underrun_ = true;
    } else {
      load(queue.front());
      queue.pop();
    }
  }
  std::uint32_t ticks = max_ticks;
  if (running_ && left_ < ticks) ticks = left_;
  if (!running_ && !queue.empty()) ticks = limit_to(queue.front().start_tick, ticks);
  for (const Run& r : runs_)
    if (r.left < ticks) ticks = r.left;
  ticks = limit_by_bits(ticks);

  block.first_tick = tick_;
  block.ticks = ticks;
  block.bits = bits();
  block.moving = running_;
  for (int a = 0; a < max_axes; ++a) block.axis[index(a)] = runs_[index(a)].run;
  advance(ticks);
  if (running_) left_ -= ticks;
  for (int a = 0; a < max_axes; ++a)
    if (runs_[index(a)].left == 0) next_piece(a);
}

}  // namespace lamplock::stepper
