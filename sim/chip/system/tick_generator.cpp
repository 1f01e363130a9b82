#include "sim/chip/system/tick_generator.hpp"

namespace lamplock::sim::chip {

TickGenerator::TickGenerator(TimeWheel& wheel, Clocks& clocks) : wheel_(wheel), clocks_(clocks) {
  clocks_.listen(*this);
  reference_hz_ = clocks_.hz(Clock::ref);
}

Wide TickGenerator::elapsed() const {
  const Wide time = wheel_.time() - base_time_;
  return base_phase_ + time * static_cast<Wide>(reference_hz_);
}

std::uint64_t TickGenerator::ticks() const {
  if (!counting()) return base_ticks_;
  return base_ticks_ + static_cast<std::uint64_t>(elapsed() / per_tick());
}

std::uint32_t TickGenerator::remaining() const {
  if (!counting()) return 0;
  const Wide left = per_tick() - elapsed() % per_tick();
  return static_cast<std::uint32_t>((left + ps_per_s - 1) / ps_per_s);
}

Cycle TickGenerator::cycle_of(std::uint64_t tick) const {
  if (tick <= ticks()) return wheel_.now();
  if (!counting()) return never_cycle;
  const Wide phase = static_cast<Wide>(tick - base_ticks_) * per_tick() - base_phase_;
  const Wide time =
      (phase + static_cast<Wide>(reference_hz_) - 1) / static_cast<Wide>(reference_hz_);
  constexpr Wide far = Wide{1} << 62;  // half a year: out of sight
  if (time > far) return never_cycle;
  return wheel_.cycle_at(base_time_ + static_cast<Picoseconds>(time));
}

// What has been counted so far becomes the new base.
void TickGenerator::rebase() {
  const std::uint64_t ticks_now = ticks();
  base_phase_ = counting() ? elapsed() % per_tick() : 0;
  base_ticks_ = ticks_now;
  base_time_ = wheel_.time();
}

void TickGenerator::configure(std::uint32_t cycles, bool enabled) {
  rebase();
  base_phase_ = 0;
  cycles_ = cycles;
  enabled_ = enabled;
  tell();
}

void TickGenerator::clocks_changed() {
  if (clocks_.hz(Clock::ref) == reference_hz_) return;
  rebase();
  reference_hz_ = clocks_.hz(Clock::ref);
  tell();
}

void TickGenerator::tell() {
  for (TickListener* listener : listeners_) listener->ticks_moved();
}

}  // namespace lamplock::sim::chip
