#include "sim/chip/system/rtc.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace lamplock::sim::chip {

namespace {

// Offsets (4.8.6).
constexpr std::uint32_t offset_divider = 0x00;
constexpr std::uint32_t offset_setup_0 = 0x04;
constexpr std::uint32_t offset_setup_1 = 0x08;
constexpr std::uint32_t offset_control = 0x0c;
constexpr std::uint32_t offset_irq_setup_0 = 0x10;
constexpr std::uint32_t offset_irq_setup_1 = 0x14;
constexpr std::uint32_t offset_rtc_1 = 0x18;
constexpr std::uint32_t offset_rtc_0 = 0x1c;
constexpr std::uint32_t offset_intr = 0x20;
constexpr std::uint32_t offset_ints = 0x2c;

// Fields of SETUP_0, IRQ_SETUP_0 and RTC_1: YEAR 23:12, MONTH 11:8, DAY 4:0; of SETUP_1,
// IRQ_SETUP_1 and RTC_0: DOTW 26:24, HOUR 20:16, MIN 13:8, SEC 5:0.
constexpr std::uint32_t year_field = 0xfffu << 12, month_field = 0xfu << 8, day_field = 0x1fu;
constexpr std::uint32_t weekday_field = 7u << 24, hour_field = 0x1fu << 16,
                        minute_field = 0x3fu << 8, second_field = 0x3fu;
constexpr std::uint32_t date_fields = year_field | month_field | day_field;
constexpr std::uint32_t time_fields = weekday_field | hour_field | minute_field | second_field;
// CTRL.
constexpr std::uint32_t control_enable = 1u << 0;
constexpr std::uint32_t control_active = 1u << 1;
constexpr std::uint32_t control_load = 1u << 4;
constexpr std::uint32_t control_no_leap_year = 1u << 8;
// IRQ_SETUP_0 and 1.
constexpr std::uint32_t match_year = 1u << 26, match_month = 1u << 25, match_day = 1u << 24;
constexpr std::uint32_t match_enable = 1u << 28, match_active = 1u << 29;
constexpr std::uint32_t match_date_bits = date_fields | match_year | match_month | match_day;
constexpr std::uint32_t match_weekday = 1u << 31, match_hour = 1u << 30, match_minute = 1u << 29,
                        match_second = 1u << 28;
constexpr std::uint32_t match_time_bits =
    time_fields | match_weekday | match_hour | match_minute | match_second;

constexpr std::uint32_t interrupt_alarm = 1u << 0;

constexpr std::uint64_t crossing_edges = 2;  // 4.8.2: two periods of clk_rtc

/// Increments a field; true: it has wrapped.
bool wraps(std::uint32_t& field, std::uint32_t last, std::uint32_t first) {
  const bool at_end = field >= last;
  field = at_end ? first : field + 1;
  return at_end;
}

}  // namespace

void RtcTime::tick(bool no_leap_year) {
  if (!wraps(second, 59, 0) || !wraps(minute, 59, 0) || !wraps(hour, 23, 0)) return;
  wraps(weekday, 6, 0);
  static constexpr std::array<std::uint32_t, 16> lengths{31, 31, 28, 31, 30, 31, 30, 31,
                                                         31, 30, 31, 30, 31, 31, 31, 31};
  const bool leap_day = month == 2 && year % 4 == 0 && !no_leap_year;
  if (!wraps(day, lengths[month & 15u] + (leap_day ? 1u : 0u), 1)) return;
  if (wraps(month, 12, 1)) wraps(year, 4095, 0);
}

Rtc::Rtc(TimeWheel& wheel, Clocks& clocks, IrqLines& irqs, NotModelled not_modelled)
    : wheel_(wheel),
      slot_(wheel.add(*this)),
      clocks_(clocks),
      irqs_(irqs),
      not_modelled_(std::move(not_modelled)),
      interrupts_(offset_intr, interrupt_alarm) {
  clocks_.listen(*this);
  counter_.set_frequency(clock_hz(), wheel_.time());
  reset();
}

void Rtc::reset() {
  time_ = {};
  divider_ = setup_date_ = setup_time_ = 0;
  no_leap_year_ = false;
  enable_ = match_ = {};
  load_at_ = second_at_ = no_cycle;
  match_date_ = match_time_ = latched_date_ = 0;
  date_latched_ = false;
  interrupts_.reset();
  schedule();
  update_irq();
}

// --- time

std::uint64_t Rtc::next_event() const {
  return std::min({enable_.at, match_.at, load_at_, second_at_});
}

void Rtc::advance() {
  if (counter_.hz() == 0) return;
  const std::uint64_t cycles = counter_.cycles(wheel_.time());
  for (std::uint64_t next = next_event(); next <= cycles; next = next_event()) happen(next);
}

/// Applies all that is due in a cycle of clk_rtc: a second, then register bits that arrive.
void Rtc::happen(std::uint64_t cycle) {
  const std::uint64_t second = divider_ + 1u;
  if (second_at_ == cycle) {
    time_.tick(no_leap_year_);
    second_at_ += second;
  }
  if (load_at_ == cycle) {
    time_ = {setup_date_ >> 12,         setup_date_ >> 8 & 0xfu,   setup_date_ & day_field,
             setup_time_ >> 24,         setup_time_ >> 16 & 0x1fu, setup_time_ >> 8 & 0x3fu,
             setup_time_ & second_field};
    load_at_ = no_cycle;
    if (enable_.arrived) second_at_ = cycle + second;
  }
  if (enable_.at == cycle) {
    enable_.at = no_cycle;
    if (enable_.wanted && !enable_.arrived) second_at_ = cycle + second;
    if (!enable_.wanted) second_at_ = no_cycle;
    enable_.arrived = enable_.wanted;
  }
  if (match_.at == cycle) {
    match_.at = no_cycle;
    match_.arrived = match_.wanted;
  }
}

void Rtc::send(Crossing& bit, bool value) {
  if (bit.wanted == value) return;
  bit.wanted = value;
  bit.at = counter_.cycles(wheel_.time()) + crossing_edges;
}

void Rtc::run(Cycle) {
  advance();
  update_irq();
  schedule();
}

void Rtc::set_clock(bool runs) {
  stopped_ = !runs;
  clocks_changed();
}

void Rtc::clocks_changed() {
  if (counter_.hz() == clock_hz()) return;
  advance();
  counter_.set_frequency(clock_hz(), wheel_.time());
  update_irq();
  schedule();
}

void Rtc::schedule() {
  const bool awaited = interrupts_.enabled() != 0 && (match_.wanted || match_.arrived);
  const Picoseconds due = awaited ? counter_.time_of(next_event()) : never;
  wheel_.set(slot_, wheel_.cycle_at(due));
}

// --- alarm

/// True if all enabled fields are equal; with none enabled, in every second (assumed).
bool Rtc::matches() const {
  if (!match_.arrived || !enable_.arrived) return false;
  const std::uint32_t date_mask = ((match_date_ & match_year) != 0 ? year_field : 0u) |
                                  ((match_date_ & match_month) != 0 ? month_field : 0u) |
                                  ((match_date_ & match_day) != 0 ? day_field : 0u);
  const std::uint32_t time_mask = ((match_time_ & match_weekday) != 0 ? weekday_field : 0u) |
                                  ((match_time_ & match_hour) != 0 ? hour_field : 0u) |
                                  ((match_time_ & match_minute) != 0 ? minute_field : 0u) |
                                  ((match_time_ & match_second) != 0 ? second_field : 0u);
  return ((date() ^ match_date_) & date_mask) == 0 &&
         ((time_of_day() ^ match_time_) & time_mask) == 0;
}

std::uint32_t Rtc::raised() const { return matches() ? interrupt_alarm : 0; }

void Rtc::update_irq() { irqs_.set(Irq::rtc, interrupts_.status(raised()) != 0); }

// --- registers

std::uint32_t Rtc::date() const { return time_.year << 12 | time_.month << 8 | time_.day; }

std::uint32_t Rtc::time_of_day() const {
  return time_.weekday << 24 | time_.hour << 16 | time_.minute << 8 | time_.second;
}

std::uint32_t Rtc::peek(std::uint32_t offset) const {
  switch (offset) {
    case offset_divider:
      return divider_;
    case offset_setup_0:
      return setup_date_;
    case offset_setup_1:
      return setup_time_;
    case offset_control:
      return (enable_.wanted ? control_enable : 0u) | (enable_.arrived ? control_active : 0u) |
             (no_leap_year_ ? control_no_leap_year : 0u);
    case offset_irq_setup_0:
      return match_date_ | (match_.wanted ? match_enable : 0u) |
             (match_.arrived ? match_active : 0u);
    case offset_irq_setup_1:
      return match_time_;
    case offset_rtc_1:
      return date_latched_ ? latched_date_ : date();
    case offset_rtc_0:
      return time_of_day();
    default:
      return interrupts_.read(offset, raised());
  }
}

// RTC_0 must be read before RTC_1: the date is latched with the time of day.
std::uint32_t Rtc::read(std::uint32_t offset) {
  if (offset > offset_ints) not_modelled_("RTC: no register at this offset");
  advance();
  if (offset == offset_rtc_0) {
    latched_date_ = date();
    date_latched_ = true;
  }
  return peek(offset);
}

void Rtc::write_control(std::uint32_t value) {
  no_leap_year_ = (value & control_no_leap_year) != 0;
  if ((value & control_load) != 0) load_at_ = counter_.cycles(wheel_.time()) + crossing_edges;
  send(enable_, (value & control_enable) != 0);
}

void Rtc::write(std::uint32_t offset, std::uint32_t value) {
  advance();
  switch (offset) {
    case offset_divider:
      divider_ = value & 0xffffu;
      if (enable_.arrived) not_modelled_("RTC CLKDIV_M1: written while the clock runs");
      break;
    case offset_setup_0:
      setup_date_ = value & date_fields;
      break;
    case offset_setup_1:
      setup_time_ = value & time_fields;
      break;
    case offset_control:
      write_control(value);
      break;
    case offset_irq_setup_0:
      match_date_ = value & match_date_bits;
      send(match_, (value & match_enable) != 0);
      break;
    case offset_irq_setup_1:
      match_time_ = value & match_time_bits;
      break;
    case offset_rtc_1:
    case offset_rtc_0:
      break;
    default:
      if (!interrupts_.write(offset, value)) not_modelled_("RTC: no register at this offset");
  }
  update_irq();
  schedule();
}

}  // namespace lamplock::sim::chip
