// RTC: date and time in binary fields, and an alarm (RP2040 datasheet, 4.8).
//
// In:  registers; clk_rtc.
// Out: date and time; the interrupt RTC_IRQ as long as the alarm matches.
// Who: the bus; the wheel at seconds, only while an alarm is armed and its interrupt enabled.
//      Otherwise the time is updated when it is read.
//
// A write to CTRL or MATCH_ENA takes effect two edges of clk_rtc later (4.8.2); reads return at
// once. Seconds are counted from when the clock was enabled or loaded (assumed). Waking the
// oscillators from dormant mode is not modelled.
#pragma once

#include <cstdint>
#include <string_view>

#include "sim/chip/fabric/interrupt_registers.hpp"
#include "sim/chip/fabric/irq_lines.hpp"
#include "sim/chip/fabric/peripheral.hpp"
#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/system/clock_counter.hpp"
#include "sim/chip/system/clocks.hpp"

namespace lamplock::sim::chip {

/// Date and time. Values are not checked, as in the chip: each field wraps at its limit.
struct RtcTime {
  std::uint32_t year = 0, month = 0, day = 0;  ///< 0..4095, 1..12, 1..31
  std::uint32_t weekday = 0;                   ///< Sunday is 0; never computed from the date
  std::uint32_t hour = 0, minute = 0, second = 0;

  /// The next second. Years that 4 divides have a February 29th, unless `no_leap_year`.
  void tick(bool no_leap_year);
};

class Rtc final : public Peripheral, private Timed, private ClockListener {
 public:
  Rtc(TimeWheel& wheel, Clocks& clocks, IrqLines& irqs, NotModelled not_modelled);
  Rtc(const Rtc&) = delete;
  Rtc& operator=(const Rtc&) = delete;

  std::string_view name() const override { return "RTC"; }
  std::uint32_t read(std::uint32_t offset) override;
  std::uint32_t peek(std::uint32_t offset) const override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  std::uint32_t write_clear_bits(std::uint32_t /*offset*/) const override { return 0; }
  void reset() override;
  /// clk_rtc stops or starts behind its gate.
  void set_clock(bool runs);

 private:
  static constexpr std::uint64_t no_cycle = ~std::uint64_t{0};
  /// A bit on its way into the domain of clk_rtc.
  struct Crossing {
    bool wanted = false, arrived = false;
    std::uint64_t at = no_cycle;  ///< cycle of clk_rtc
  };

  void run(Cycle to) override;
  void clock_changed() override { schedule(); }
  void clocks_changed() override;

  std::uint64_t clock_hz() const { return stopped_ ? 0 : clocks_.hz(Clock::rtc); }
  std::uint64_t next_event() const;
  void advance();
  void happen(std::uint64_t cycle);
  void send(Crossing& bit, bool value);
  void write_control(std::uint32_t value);
  std::uint32_t date() const;
  std::uint32_t time_of_day() const;
  bool matches() const;
  std::uint32_t raised() const;
  void schedule();
  void update_irq();

  TimeWheel& wheel_;
  TimeWheel::Slot slot_;
  Clocks& clocks_;
  IrqLines& irqs_;
  NotModelled not_modelled_;
  bool stopped_ = false;  ///< behind its gate
  ClockCounter counter_;  ///< of clk_rtc

  RtcTime time_{};
  std::uint32_t divider_ = 0;  ///< CLKDIV_M1
  std::uint32_t setup_date_ = 0, setup_time_ = 0;
  bool no_leap_year_ = false;
  Crossing enable_{}, match_{};
  std::uint64_t load_at_ = no_cycle, second_at_ = no_cycle;  ///< cycles of clk_rtc
  std::uint32_t match_date_ = 0, match_time_ = 0;            ///< IRQ_SETUP_0, 1 without MATCH_ENA
  std::uint32_t latched_date_ = 0;                           ///< taken with the reading of RTC_0
  bool date_latched_ = false;
  InterruptRegisters interrupts_;
};

}  // namespace lamplock::sim::chip
