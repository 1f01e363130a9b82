// CLOCKS: which source, divided by what, drives which part (RP2040 datasheet, 2.15).
//
// In:  frequencies of the sources, those on GPIN0 and GPIN1 included; registers.
// Out: the frequency of each clock; clk_sys is the wheel's. Listeners are informed of changes.
//      GPOUT0-3 on their pins; the interrupt of the resuscitation of clk_sys. Blocks are informed
//      when WAKE_EN or SLEEP_EN stops their clocks (2.15.3.5); the blocks stop themselves.
// Who: the bus; UART, tick generator and other blocks that need the frequency of a clock.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "sim/chip/fabric/interrupt_registers.hpp"
#include "sim/chip/fabric/irq_lines.hpp"
#include "sim/chip/fabric/peripheral.hpp"
#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/gpio/function_pins.hpp"
#include "sim/chip/system/clock_enables.hpp"
#include "sim/chip/system/clock_outputs.hpp"
#include "sim/chip/system/oscillators.hpp"
#include "sim/chip/system/resets.hpp"

namespace lamplock::sim::chip {

/// The generators in the order of their registers.
enum class Clock : std::uint8_t { gpout0, gpout1, gpout2, gpout3, ref, sys, peri, usb, adc, rtc };
inline constexpr std::size_t clock_count = 10;

/// Called after a clock other than clk_sys has changed (for clk_sys: Timed::clock_changed).
class ClockListener {
 public:
  virtual ~ClockListener() = default;
  virtual void clocks_changed() = 0;
};

/// The clock generators and the frequency counter.
class Clocks final : public Peripheral, private Timed, private FunctionPins::User {
 public:
  /// Cycles of clk_sys until a glitchless multiplexer has changed over. The datasheet says that it
  /// takes a few cycles of both clocks (2.15.3.2); the number is assumed.
  static constexpr Cycle mux_cycles = 4;

  /// Whether a block is held in reset: its clocks may be stopped unnoticed.
  using Held = std::function<bool(ResetBit)>;

  Clocks(TimeWheel& wheel, Xosc& xosc, Rosc& rosc, Pll& pll_sys, Pll& pll_usb, FunctionPins& pins,
         IrqLines& irqs, Held held, NotModelled not_modelled);
  Clocks(const Clocks&) = delete;
  Clocks& operator=(const Clocks&) = delete;

  /// Frequency of a clock; 0: it is stopped.
  std::uint64_t hz(Clock clock) const { return hz_[static_cast<std::size_t>(clock)]; }
  /// Sets the frequency of the outside clock on GPIN0 (GPIO 20) or GPIN1 (GPIO 22); edges are not
  /// simulated. It has effect if the pin has the function. 0: none.
  void set_input_hz(unsigned input, std::uint64_t hz);
  void listen(ClockListener& listener) { listeners_.push_back(&listener); }
  /// Calls `changed` with false when the clock behind a gate stops, with true when it starts again.
  void on_gate(ClockGate gate, std::function<void(bool runs)> changed);
  /// In system sleep SLEEP_EN decides, otherwise WAKE_EN (2.11.2).
  void set_asleep(bool asleep);

  std::string_view name() const override { return "CLOCKS"; }
  std::uint32_t read(std::uint32_t offset) override;
  std::uint32_t peek(std::uint32_t offset) const override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  std::uint32_t write_clear_bits(std::uint32_t /*offset*/) const override { return 0; }
  void reset() override;

 private:
  struct Generator {
    std::uint32_t control = 0;
    std::uint32_t divider = 0;
    std::uint32_t selected = 0;  ///< of the glitchless multiplexer: SRC in use
  };

  /// What a multiplexer or the counter can select.
  enum class Source : std::uint8_t;

  void run(Cycle to) override;
  void pins_changed(Cycle at) override;
  void refresh();
  void set_system_clock();
  void write_resus(std::uint32_t value);
  std::uint64_t input_hz(unsigned input) const;
  std::uint64_t hz_of(Source source) const;
  /// Returns `nothing` for reserved numbers.
  template <std::size_t size>
  static Source pick(const std::array<Source, size>& table, std::uint32_t index);
  std::uint64_t divisor(Clock clock) const;
  std::uint64_t generated(Clock clock) const;
  std::uint64_t source_hz(Clock clock) const;
  std::uint64_t auxiliary_hz(Clock clock) const;
  void write_generator(std::size_t index, std::uint32_t reg, std::uint32_t value);
  void change_over();
  void start_counter(std::uint32_t source);
  bool counter_done() const;
  std::uint64_t counted_hz() const;
  std::uint32_t counter_result() const;
  std::uint32_t counter_status() const;
  void write_enables(std::uint32_t offset, std::uint32_t value);
  std::uint32_t raised() const { return resussed_ ? interrupt_resus : 0; }
  void apply_enables();
  void report_gate(std::size_t bit) const;
  void update_irq();

  TimeWheel& wheel_;
  TimeWheel::Slot slot_;
  Xosc& xosc_;
  Rosc& rosc_;
  Pll& pll_sys_;
  Pll& pll_usb_;
  IrqLines& irqs_;
  FunctionPins& pins_;
  Held held_;
  NotModelled not_modelled_;
  ClockOutputs outputs_;
  std::vector<ClockListener*> listeners_;

  static constexpr std::uint32_t interrupt_resus = 1u << 0;  ///< CLK_SYS_RESUS

  std::array<Generator, clock_count> generators_{};
  std::array<std::uint64_t, clock_count> hz_{};
  std::array<std::uint64_t, 2> input_hz_{};
  bool refreshing_ = false;
  bool stopped_ = false;   ///< clk_sys, until the resuscitation has counted its time
  bool resussed_ = false;  ///< clk_sys is forced to clk_ref
  std::uint32_t resus_control_ = 0;
  std::array<std::uint32_t, 6> counter_{};  ///< FC0: REF_KHZ, MIN, MAX, DELAY, INTERVAL, SRC
  std::uint64_t counted_hz_ = 0;            ///< of the clock that is or was counted
  Picoseconds counter_end_ = 0;
  std::array<std::uint32_t, 2> wake_enable_{}, sleep_enable_{};
  InterruptRegisters interrupts_;
  std::array<std::uint32_t, 2> enabled_{};  ///< the one that applies
  bool asleep_ = false;
  std::array<std::function<void(bool)>, clock_enables.size()> gates_;
};

}  // namespace lamplock::sim::chip
