// TIMER: 64 bits of microseconds and four alarms (RP2040 datasheet, 4.6).
//
// In:  ticks; registers.
// Out: the interrupt lines TIMER_IRQ_0-3, in the cycle of clk_sys in which the tick falls.
// Who: the bus; the wheel at each alarm. Nothing happens per microsecond.
#pragma once

#include <array>
#include <cstdint>

#include "sim/chip/fabric/interrupt_registers.hpp"
#include "sim/chip/fabric/irq_lines.hpp"
#include "sim/chip/fabric/peripheral.hpp"
#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/system/tick_generator.hpp"

namespace lamplock::sim::chip {

/// The system timer. An alarm that is written with the present value of the counter fires when the
/// counter next reaches that value.
class Timer final : public Peripheral, private Timed, private TickListener {
 public:
  Timer(TimeWheel& wheel, TickGenerator& ticks, IrqLines& irqs, NotModelled not_modelled);
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;

  /// Microseconds now, without side effects.
  std::uint64_t time() const;

  std::string_view name() const override { return "TIMER"; }
  std::uint32_t read(std::uint32_t offset) override;
  std::uint32_t peek(std::uint32_t offset) const override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  std::uint32_t write_clear_bits(std::uint32_t offset) const override;
  void reset() override;
  /// Its clock stops, and time with it, or starts.
  void set_clock(bool runs);

 private:
  static constexpr std::size_t alarm_count = 4;

  void run(Cycle to) override;
  void clock_changed() override { schedule(); }
  void ticks_moved() override { schedule(); }
  void set_time(std::uint64_t time);
  void arm(std::size_t alarm, std::uint32_t value);
  void schedule();
  void update_irqs();

  TimeWheel& wheel_;
  TimeWheel::Slot slot_;
  TickGenerator& ticks_;
  IrqLines& irqs_;
  NotModelled not_modelled_;
  std::uint64_t base_time_ = 0, base_ticks_ = 0;
  std::uint32_t high_latch_ = 0, low_written_ = 0;
  std::array<std::uint32_t, alarm_count> alarms_{};
  std::array<std::uint64_t, alarm_count> due_{};  ///< full time at which an armed alarm fires
  std::uint32_t armed_ = 0;
  std::uint32_t debug_pause_ = 0;
  bool paused_ = false;
  bool stopped_ = false;      ///< no clock
  std::uint32_t raised_ = 0;  ///< INTR
  InterruptRegisters interrupts_;
};

}  // namespace lamplock::sim::chip
