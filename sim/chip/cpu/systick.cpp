#include "sim/chip/cpu/systick.hpp"

#include <utility>

namespace lamplock::sim::chip {

SysTick::SysTick(TimeWheel& wheel, std::function<void()> pend)
    : wheel_(wheel), pend_(std::move(pend)), slot_(wheel.add(*this)) {}

void SysTick::reset(Cycle now) {
  base_ = now;
  control_ = reload_ = current_ = 0;
  counted_ = false;
  schedule();
}

Cycle SysTick::period() const {
  if ((control_ & enable) == 0) return 0;
  return uses_reference() ? reference_ : 1;
}

Cycle SysTick::begin(Cycle now) const {
  if (!uses_reference() || reference_ == 0) return now;
  if (now < reference_tick_) return reference_tick_ - reference_;
  return now - (now - reference_tick_) % reference_;
}

void SysTick::sync(Cycle now) {
  const Cycle length = period();
  if (length == 0 || now <= base_) {
    if (now > base_) base_ = now;
    return;
  }
  const Cycle counts = (now - base_) / length;
  base_ += counts * length;
  if (counts < current_) {
    current_ -= static_cast<std::uint32_t>(counts);
    return;
  }
  // From zero on: reload, count down, zero, once each reload + 1 counts; with reload 0 it stays.
  const Cycle past_zero = counts - current_;
  const Cycle round = Cycle{reload_} + 1;
  Cycle zeros = current_ != 0 ? 1 : 0;
  if (reload_ != 0) zeros += past_zero / round;
  const Cycle phase = past_zero % round;
  current_ = phase == 0 ? 0 : static_cast<std::uint32_t>(round - phase);
  if (zeros == 0) return;
  counted_ = true;
  if ((control_ & interrupt) != 0) pend_();
}

void SysTick::schedule() {
  const Cycle length = period();
  Cycle counts = current_;
  if (counts == 0 && reload_ != 0) counts = Cycle{reload_} + 1;
  wheel_.set(slot_, length == 0 || counts == 0 ? never_cycle : base_ + counts * length);
}

void SysTick::run(Cycle to) {
  sync(to);
  schedule();
}

std::uint32_t SysTick::read_control(Cycle now) {
  sync(now);
  const std::uint32_t value = control_ | (counted_ ? count_flag : 0);
  counted_ = false;
  return value;
}

void SysTick::write_control(std::uint32_t value, Cycle now) {
  sync(now);
  control_ = value & (enable | interrupt | clock_source);
  base_ = begin(now);
  schedule();
}

void SysTick::write_reload(std::uint32_t value, Cycle now) {
  sync(now);
  reload_ = value & 0x00ff'ffff;
  schedule();
}

std::uint32_t SysTick::read_current(Cycle now) {
  sync(now);
  return current_;
}

void SysTick::clear_current(Cycle now) {
  sync(now);
  current_ = 0;
  counted_ = false;
  schedule();
}

void SysTick::set_reference(Cycle cycles, Cycle tick, Cycle now) {
  sync(now);
  reference_ = cycles;
  reference_tick_ = tick;
  base_ = begin(now);
  schedule();
}

}  // namespace lamplock::sim::chip
