#include "sim/chip/system/tick_generator.hpp"

namespace lamplock::sim::chip {

TickGenerator::TickGenerator(TimeWheel& wheel, Clocks& clocks) : wheel_(wheel), clocks_(clocks) {
  clocks_.listen(*this);
  counter_.set_frequency(clocks_.hz(Clock::ref), wheel_.time());
}

std::uint64_t TickGenerator::ticks() const {
  if (!enabled_ || cycles_ == 0) return base_ticks_;
  return base_ticks_ + counter_.cycles(wheel_.time()) / cycles_;
}

std::uint32_t TickGenerator::remaining() const {
  if (!counting()) return 0;
  return cycles_ - static_cast<std::uint32_t>(counter_.cycles(wheel_.time()) % cycles_);
}

Cycle TickGenerator::cycle_of(std::uint64_t tick) const {
  if (tick <= ticks()) return wheel_.now();
  if (!counting()) return never_cycle;
  return wheel_.cycle_at(counter_.time_of((tick - base_ticks_) * cycles_));
}

void TickGenerator::configure(std::uint32_t cycles, bool enabled) {
  base_ticks_ = ticks();
  counter_ = {};
  counter_.set_frequency(clocks_.hz(Clock::ref), wheel_.time());
  cycles_ = cycles;
  enabled_ = enabled;
  report();
}

void TickGenerator::clocks_changed() {
  const std::uint64_t hz = clocks_.hz(Clock::ref);
  if (hz == counter_.hz()) return;
  counter_.set_frequency(hz, wheel_.time());
  report();
}

void TickGenerator::report() {
  for (TickListener* listener : listeners_) listener->ticks_moved();
}

}  // namespace lamplock::sim::chip
