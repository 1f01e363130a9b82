#include "sim/chip/system/timer.hpp"

#include <algorithm>
#include <utility>

namespace lamplock::sim::chip {

namespace {

// Offsets (4.6.5).
constexpr std::uint32_t offset_time_high_write = 0x00;
constexpr std::uint32_t offset_time_low_write = 0x04;
constexpr std::uint32_t offset_time_high_read = 0x08;
constexpr std::uint32_t offset_time_low_read = 0x0c;
constexpr std::uint32_t offset_alarm0 = 0x10;
constexpr std::uint32_t offset_armed = 0x20;
constexpr std::uint32_t offset_raw_high = 0x24;
constexpr std::uint32_t offset_raw_low = 0x28;
constexpr std::uint32_t offset_debug_pause = 0x2c;  // DBG0 1, DBG1 2
constexpr std::uint32_t offset_pause = 0x30;
constexpr std::uint32_t offset_intr = 0x34;
constexpr std::uint32_t offset_ints = 0x40;

constexpr std::uint32_t alarm_mask = 0xf;
constexpr std::uint32_t debug_pause_reset = 0x7;
constexpr std::uint64_t wrap = 1ull << 32;  // alarms compare the low half only

}  // namespace

Timer::Timer(TimeWheel& wheel, TickGenerator& ticks, IrqLines& irqs, NotModelled not_modelled)
    : wheel_(wheel),
      slot_(wheel.add(*this)),
      ticks_(ticks),
      irqs_(irqs),
      not_modelled_(std::move(not_modelled)),
      interrupts_(offset_intr, alarm_mask) {
  ticks_.listen(*this);
  reset();
}

void Timer::reset() {
  paused_ = false;
  set_time(0);
  high_latch_ = low_written_ = 0;
  alarms_ = {};
  armed_ = raised_ = 0;
  interrupts_.reset();
  debug_pause_ = debug_pause_reset;
  schedule();
  update_irqs();
}

std::uint64_t Timer::time() const {
  return paused_ || stopped_ ? base_time_ : base_time_ + (ticks_.ticks() - base_ticks_);
}

void Timer::set_time(std::uint64_t time) {
  base_time_ = time;
  base_ticks_ = ticks_.ticks();
  for (std::size_t alarm = 0; alarm < alarm_count; ++alarm)
    if ((armed_ >> alarm & 1u) != 0) arm(alarm, alarms_[alarm]);
}

void Timer::arm(std::size_t alarm, std::uint32_t value) {
  alarms_[alarm] = value;
  const std::uint64_t now = time();
  const std::uint64_t ahead = (value - static_cast<std::uint32_t>(now)) & 0xffffffffu;
  due_[alarm] = now + (ahead == 0 ? wrap : ahead);
  armed_ |= 1u << alarm;
}

void Timer::set_clock(bool runs) {
  const std::uint64_t now = time();
  stopped_ = !runs;
  set_time(now);
  schedule();
}

void Timer::schedule() {
  std::uint64_t first = ~0ull;
  for (std::size_t alarm = 0; alarm < alarm_count; ++alarm)
    if ((armed_ >> alarm & 1u) != 0) first = std::min(first, due_[alarm]);
  wheel_.set(slot_, first == ~0ull || paused_ || stopped_
                        ? never_cycle
                        : ticks_.cycle_of(base_ticks_ + (first - base_time_)));
}

void Timer::run(Cycle) {
  const std::uint64_t now = time();
  for (std::size_t alarm = 0; alarm < alarm_count; ++alarm) {
    if ((armed_ >> alarm & 1u) == 0 || due_[alarm] > now) continue;
    armed_ &= ~(1u << alarm);
    raised_ |= 1u << alarm;
  }
  update_irqs();
  schedule();
}

void Timer::update_irqs() {
  constexpr std::array<Irq, alarm_count> lines{Irq::timer_0, Irq::timer_1, Irq::timer_2,
                                               Irq::timer_3};
  const std::uint32_t status = interrupts_.status(raised_);
  for (std::size_t alarm = 0; alarm < alarm_count; ++alarm)
    irqs_.set(lines[alarm], (status >> alarm & 1u) != 0);
}

std::uint32_t Timer::peek(std::uint32_t offset) const {
  switch (offset) {
    case offset_time_high_read:
      return high_latch_;
    case offset_time_low_read:
    case offset_raw_low:
      return static_cast<std::uint32_t>(time());
    case offset_raw_high:
      return static_cast<std::uint32_t>(time() >> 32);
    case offset_alarm0:
    case offset_alarm0 + 4:
    case offset_alarm0 + 8:
    case offset_alarm0 + 12:
      return alarms_[(offset - offset_alarm0) / 4];
    case offset_armed:
      return armed_;
    case offset_debug_pause:
      return debug_pause_;
    case offset_pause:
      return paused_ ? 1 : 0;
    default:
      return interrupts_.read(offset, raised_);  // TIMEHW, TIMELW: 0
  }
}

std::uint32_t Timer::read(std::uint32_t offset) {
  if (offset > offset_ints) not_modelled_("TIMER: no register at this offset");
  // TIMELR latches the upper half for TIMEHR.
  if (offset == offset_time_low_read) high_latch_ = static_cast<std::uint32_t>(time() >> 32);
  return peek(offset);
}

std::uint32_t Timer::write_clear_bits(std::uint32_t offset) const {
  return offset == offset_armed || offset == offset_intr ? alarm_mask : 0;
}

void Timer::write(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case offset_time_low_write:
      low_written_ = value;
      break;
    case offset_time_high_write:  // takes both halves over
      set_time(static_cast<std::uint64_t>(value) << 32 | low_written_);
      break;
    case offset_alarm0:
    case offset_alarm0 + 4:
    case offset_alarm0 + 8:
    case offset_alarm0 + 12:
      arm((offset - offset_alarm0) / 4, value);
      break;
    case offset_armed:
      armed_ &= ~value;
      break;  // ones disarm
    case offset_debug_pause:
      debug_pause_ = value & 6u;
      break;
    case offset_pause: {
      const std::uint64_t now = time();
      paused_ = (value & 1u) != 0;
      set_time(now);
      break;
    }
    case offset_intr:
      raised_ &= ~(value & alarm_mask);
      break;
    case offset_time_high_read:
    case offset_time_low_read:
    case offset_raw_high:
    case offset_raw_low:
      break;
    default:
      if (!interrupts_.write(offset, value)) not_modelled_("TIMER: no register at this offset");
  }
  schedule();
  update_irqs();
}

}  // namespace lamplock::sim::chip
