#include "sim/chip/system/watchdog.hpp"

#include <utility>

namespace lamplock::sim::chip {

namespace {

// Offsets (4.7.6).
constexpr std::uint32_t offset_control = 0x00;
constexpr std::uint32_t offset_load = 0x04;
constexpr std::uint32_t offset_reason = 0x08;
constexpr std::uint32_t offset_scratch0 = 0x0c;
constexpr std::uint32_t offset_tick = 0x2c;
// CTRL: TIME 23:0, PAUSE_JTAG 24, PAUSE_DBG0 25, PAUSE_DBG1 26, ENABLE 30, TRIGGER 31.
constexpr std::uint32_t control_enable = 1u << 30;
constexpr std::uint32_t control_trigger = 1u << 31;
constexpr std::uint32_t control_kept = 0x47000000;
constexpr std::uint32_t control_reset = 0x07000000;
constexpr std::uint32_t time_mask = 0x00ffffff;
// TICK: CYCLES 8:0, ENABLE 9, RUNNING 10, COUNT 19:11.
constexpr std::uint32_t tick_cycles = 0x1ff;
constexpr std::uint32_t tick_enable = 1u << 9;
constexpr std::uint32_t tick_reset = tick_enable;

constexpr std::uint32_t reason_timer = 1;
constexpr std::uint32_t reason_force = 2;
constexpr std::uint64_t counts_per_tick = 2;  // erratum RP2040-E1

}  // namespace

Watchdog::Watchdog(TimeWheel& wheel, TickGenerator& ticks, NotModelled not_modelled, Fired fired)
    : wheel_(wheel),
      slot_(wheel.add(*this)),
      ticks_(ticks),
      not_modelled_(std::move(not_modelled)),
      fired_(std::move(fired)) {
  ticks_.listen(*this);
  reset();
}

void Watchdog::reset() {
  control_ = control_reset;
  base_count_ = 0;
  base_ticks_ = ticks_.ticks();
  reason_ = 0;
  scratch_ = {};
  exhausted_ = false;
  tick_ = tick_reset;
  ticks_.configure(0, true);
  schedule();
}

std::uint32_t Watchdog::count() const {
  if ((control_ & control_enable) == 0 || stopped_) return base_count_;
  const std::uint64_t counted = counts_per_tick * (ticks_.ticks() - base_ticks_);
  return counted >= base_count_ ? 0 : base_count_ - static_cast<std::uint32_t>(counted);
}

/// Stores the count so far, before a value that it depends on changes.
void Watchdog::hold_count() {
  base_count_ = count();
  base_ticks_ = ticks_.ticks();
}

void Watchdog::set_clock(bool runs) {
  hold_count();
  stopped_ = !runs;
  schedule();
}

void Watchdog::schedule() {
  const bool counting = (control_ & control_enable) != 0 && !exhausted_ && !stopped_;
  const std::uint64_t ticks = (base_count_ + counts_per_tick - 1) / counts_per_tick;
  wheel_.set(slot_,
             counting ? ticks_.cycle_of(base_ticks_ + (ticks == 0 ? 1 : ticks)) : never_cycle);
}

void Watchdog::run(Cycle) {
  if ((control_ & control_enable) == 0 || count() != 0) return schedule();
  hold_count();
  exhausted_ = true;
  fire(reason_timer);
}

void Watchdog::fire(std::uint32_t reason) {
  reason_ = reason;
  if (fired_) fired_();
}

bool Watchdog::was_forced() const { return reason_ == reason_force; }

std::uint32_t Watchdog::read(std::uint32_t offset) {
  if (offset > offset_tick) not_modelled_("WATCHDOG: no register at this offset");
  return peek(offset);
}

std::uint32_t Watchdog::peek(std::uint32_t offset) const {
  switch (offset) {
    case offset_control:
      return control_ | count();
    case offset_load:
      return 0;  // write only
    case offset_reason:
      return reason_;
    case offset_tick:
      return tick_ | (ticks_.running() ? 1u << 10 : 0u) | (ticks_.remaining() & 0x1ffu) << 11;
    default:
      return offset < offset_tick ? scratch_[(offset - offset_scratch0) / 4] : 0;
  }
}

void Watchdog::write_control(std::uint32_t value) {
  hold_count();
  control_ = value & control_kept;
  schedule();
  if ((value & control_trigger) != 0) fire(reason_force);
}

void Watchdog::write(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case offset_control:
      return write_control(value);
    case offset_load:
      base_count_ = value & time_mask;
      base_ticks_ = ticks_.ticks();
      exhausted_ = false;
      return schedule();
    case offset_reason:
      return;
    case offset_tick:
      hold_count();
      tick_ = value & (tick_cycles | tick_enable);
      return ticks_.configure(tick_ & tick_cycles, (tick_ & tick_enable) != 0);
    default:
      break;
  }
  if (offset < offset_tick)
    scratch_[(offset - offset_scratch0) / 4] = value;
  else
    not_modelled_("WATCHDOG: no register at this offset");
}

}  // namespace lamplock::sim::chip
