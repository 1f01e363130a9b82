// ADC: one converter of 12 bits behind a multiplexer of four pins and the temperature sensor
// (RP2040 datasheet, 4.9).
//
// In:  registers; volts at GPIO26 to 29 and the temperature of the die, set from outside; clk_adc.
// Out: results; the interrupt ADC_IRQ_FIFO; the DREQ.
// Who: the bus; the wheel at the end of conversions that an interrupt or the DMA waits for. A
//      free-running converter that no other part waits for costs nothing until it is read.
//
// A conversion takes 96 cycles of clk_adc from the first edge of that clock at or after the write.
// It is ideal: noise, offset and the steps of erratum E11 are not modelled. The input is taken at
// the start of the conversion (assumed).
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "sim/chip/fabric/dreq_lines.hpp"
#include "sim/chip/fabric/interrupt_registers.hpp"
#include "sim/chip/fabric/irq_lines.hpp"
#include "sim/chip/fabric/peripheral.hpp"
#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/system/clock_counter.hpp"
#include "sim/chip/system/clocks.hpp"

namespace lamplock::sim::chip {

/// The converter with its FIFO.
class Adc final : public Peripheral, private Timed, private ClockListener {
 public:
  static constexpr unsigned pin_inputs = 4;  ///< input n is GPIO 26 + n
  static constexpr unsigned temperature_input = 4;
  static constexpr std::uint64_t conversion_cycles = 96;  ///< of clk_adc (4.9.1)
  static constexpr double reference_volts = 3.3;          ///< ADC_AVDD of the usual board

  Adc(TimeWheel& wheel, Clocks& clocks, IrqLines& irqs, NotModelled not_modelled);
  Adc(const Adc&) = delete;
  Adc& operator=(const Adc&) = delete;

  void connect(DreqLines& lines) { dreqs_ = &lines; }
  /// Volts at GPIO 26 + `input` from now on; results stop at 0 and 4095.
  void set_input(unsigned input, double volts);
  /// Temperature of the die from now on: 0.706 V at 27 degrees, 1.721 mV less per degree (4.9.5).
  void set_temperature(double celsius);
  /// The next conversion to start reports an error.
  void fail_next_conversion() { fail_next_ = true; }

  std::string_view name() const override { return "ADC"; }
  std::uint32_t read(std::uint32_t offset) override;
  std::uint32_t peek(std::uint32_t offset) const override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  std::uint32_t write_clear_bits(std::uint32_t offset) const override;
  void reset() override;
  /// clk_adc stops or starts behind its gate.
  void set_clock(bool runs);

 private:
  static constexpr unsigned fifo_depth = 4;  // 4.9.2.2

  void run(Cycle to) override;
  void clock_changed() override { schedule(); }
  void clocks_changed() override;

  bool on(std::uint32_t control_bit) const { return (control_ & control_bit) != 0; }
  std::uint64_t clock_hz() const { return stopped_ ? 0 : clocks_.hz(Clock::adc); }
  std::uint64_t period() const;
  std::uint64_t trigger(std::uint64_t number) const;
  std::uint32_t selected_input() const { return control_ >> 12 & 7u; }
  void advance();
  void skip_unseen(std::uint64_t cycles);
  void start(std::uint64_t cycle);
  void finish();
  void select_next_input();
  void push(std::uint32_t result);
  std::uint32_t pop();
  std::uint32_t convert(std::uint32_t input);
  bool fifo_triggers() const;
  std::uint32_t raised() const;
  std::uint32_t status() const;
  std::uint32_t fifo_status() const;
  void write_control(std::uint32_t value);
  void write_divider(std::uint32_t value);
  void schedule();
  void update_lines();

  TimeWheel& wheel_;
  TimeWheel::Slot slot_;
  Clocks& clocks_;
  IrqLines& irqs_;
  DreqLines* dreqs_ = nullptr;
  NotModelled not_modelled_;
  bool stopped_ = false;  ///< behind its gate
  ClockCounter counter_;  ///< of clk_adc

  std::array<double, pin_inputs + 1> volts_{};
  bool fail_next_ = false;

  std::uint32_t control_ = 0;  ///< CS without its read-only bits
  std::uint32_t fifo_control_ = 0, divider_ = 0;
  InterruptRegisters interrupts_;
  bool converting_ = false;
  std::uint64_t started_ = 0;                ///< cycle of the conversion under way
  std::uint64_t origin_ = 0, triggers_ = 0;  ///< START_MANY: cycle of trigger 0, how many were
  std::uint32_t sample_ = 0;                 ///< of the conversion under way
  bool sample_failed_ = false, failed_ = false, ever_failed_ = false;
  std::uint32_t result_ = 0;
  std::array<std::uint32_t, fifo_depth> fifo_{};
  unsigned fifo_level_ = 0;
  bool overflowed_ = false, underflowed_ = false;
};

}  // namespace lamplock::sim::chip
