// The 24-bit timer of a core (ARMv6-M Architecture Reference Manual, B3.3).
//
// In:  register accesses; the clock (clk_sys, or the tick of the watchdog block as the reference).
// Out: its exception, at the cycle in which the count goes from 1 to 0. Between two of these the
//      count is computed only when it is read.
#pragma once

#include <cstdint>
#include <functional>

#include "sim/chip/fabric/time_wheel.hpp"

namespace lamplock::sim::chip {

/// One timer. CALIB reads zero, as on the RP2040 (datasheet, 2.4.8).
class SysTick final : public Timed {
 public:
  SysTick(TimeWheel& wheel, std::function<void()> pend);

  void reset(Cycle now);
  std::uint32_t read_control(Cycle now);
  /// CTRL without the side effect of a read, as of the last run().
  std::uint32_t peek_control() const { return control_ | (counted_ ? count_flag : 0); }
  void write_control(std::uint32_t value, Cycle now);
  std::uint32_t reload() const { return reload_; }
  void write_reload(std::uint32_t value, Cycle now);
  std::uint32_t read_current(Cycle now);
  /// Any write clears the count and COUNTFLAG.
  void clear_current(Cycle now);

  /// Cycles of clk_sys in a period of the reference (1 us tick of WATCHDOG), 0 if it has stopped,
  /// and the cycle of one of its ticks, at most a period from now.
  void set_reference(Cycle cycles, Cycle tick, Cycle now);
  bool uses_reference() const { return (control_ & clock_source) == 0; }
  bool reference_runs() const { return reference_ != 0; }

  void run(Cycle to) override;

 private:
  static constexpr std::uint32_t enable = 1u << 0, interrupt = 1u << 1, clock_source = 1u << 2,
                                 count_flag = 1u << 16;

  /// Clocks of the counter's source in one count; 0: it has stopped.
  Cycle period() const;
  /// Where counting begins: now, or at the reference's last tick.
  Cycle begin(Cycle now) const;
  void sync(Cycle now);
  void schedule();

  TimeWheel& wheel_;
  std::function<void()> pend_;
  TimeWheel::Slot slot_;
  Cycle reference_ = 0, reference_tick_ = 0;
  Cycle base_ = 0;  ///< the count was `current_` at this cycle
  std::uint32_t control_ = 0;
  std::uint32_t reload_ = 0;
  std::uint32_t current_ = 0;
  bool counted_ = false;  ///< COUNTFLAG
};

}  // namespace lamplock::sim::chip
