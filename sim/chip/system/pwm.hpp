// PWM: eight slices of two channels (RP2040 datasheet, 4.5).
//
// In:  registers; the levels of the pins that channels B count.
// Out: levels on the pins; the interrupt PWM_IRQ_WRAP; a request to the DMA for each wrap.
// Who: the bus; the wheel at edges of outputs that are connected to a pin, and at wraps that an
//      interrupt or the DMA waits for. Any other slice costs nothing: its counter has a closed
//      form.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "sim/chip/fabric/dreq_lines.hpp"
#include "sim/chip/fabric/interrupt_registers.hpp"
#include "sim/chip/fabric/irq_lines.hpp"
#include "sim/chip/fabric/peripheral.hpp"
#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/gpio/gpio.hpp"

namespace lamplock::sim::chip {

/// One slice: a divider of 8.4 bits, a counter, two comparators.
///
/// The counter is kept as a position in its period: 0 to TOP up, and in phase-correct mode as many
/// steps down again.
class PwmSlice {
 public:
  enum class Mode : std::uint8_t { free_running, gated, rising, falling };

  std::uint32_t read(std::uint32_t offset) const;
  void write(std::uint32_t offset, std::uint32_t value);
  bool enabled() const { return (control_ & 1u) != 0; }
  void enable(bool on) { control_ = (control_ & ~1u) | (on ? 1u : 0u); }
  Mode mode() const { return static_cast<Mode>(control_ >> 4 & 3u); }

  /// Lets `clocks` cycles of clk_sys pass.
  void advance(std::uint64_t clocks);
  /// The pin of channel B: gates the counter, or steps it with its edges.
  void set_input(bool level);
  /// Cycles of clk_sys until an output may change (or, with `wraps_only`, until the counter wraps);
  /// never_cycle: it does not run by itself.
  Cycle until_event(bool wraps_only) const;
  /// Outputs A (bit 0) and B (bit 1), and which of them are outputs.
  std::uint32_t outputs() const;
  std::uint32_t enables() const { return mode() == Mode::free_running ? 3u : 1u; }
  /// Whether the counter has wrapped since this was last called.
  bool take_wrapped();

 private:
  bool counts_clocks() const;
  bool phase_correct() const { return (control_ & 2u) != 0; }
  std::uint64_t divisor() const;  ///< in sixteenths
  std::uint64_t period() const;
  std::uint64_t counter() const;
  void set_counter(std::uint32_t value);
  void step(std::uint64_t counts);
  void latch();
  std::uint64_t counts_to_event(bool wraps_only) const;

  std::uint32_t control_ = 0;
  std::uint32_t divider_ = 0x10;
  std::uint32_t compare_ = 0, top_ = 0xffff;                  ///< in use
  std::uint32_t compare_written_ = 0, top_written_ = 0xffff;  ///< taken over at the wrap
  std::uint64_t position_ = 0;
  std::uint64_t fraction_ = 0;  ///< sixteenths towards the next count
  std::uint64_t retards_ = 0;   ///< counts still to be lost (PH_RET)
  bool input_ = false;
  bool wrapped_ = false;
};

class Pwm final : public Peripheral, private Timed, private InputListener, private DreqPulser {
 public:
  static constexpr std::size_t slice_count = 8;

  Pwm(TimeWheel& wheel, Gpio& gpio, IrqLines& irqs, NotModelled not_modelled);
  Pwm(const Pwm&) = delete;
  Pwm& operator=(const Pwm&) = delete;

  void connect(DreqLines& lines) {
    dreqs_ = &lines;
    lines.connect(*this);
  }

  std::string_view name() const override { return "PWM"; }
  std::uint32_t read(std::uint32_t offset) override;
  std::uint32_t peek(std::uint32_t offset) const override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  std::uint32_t write_clear_bits(std::uint32_t offset) const override;
  void reset() override;
  /// Its clock stops (counters and outputs stay, edges of inputs are not seen) or starts again.
  void set_clock(bool runs);

 private:
  void run(Cycle to) override;
  void inputs_changed(Cycle at) override;
  void catch_up(Cycle at) override;
  void connections_changed(Cycle at) override;
  void wraps_awaited(std::uint32_t slices) override;
  void advance(Cycle to);
  void settle(Cycle at);
  bool connected(std::size_t slice) const;
  void drive(Cycle at);
  void take_inputs();
  void collect_wraps();
  void schedule();
  void update_irq();

  TimeWheel& wheel_;
  TimeWheel::Slot slot_;
  Gpio& gpio_;
  IrqLines& irqs_;
  NotModelled not_modelled_;
  std::array<PwmSlice, slice_count> slices_{};
  Cycle time_ = 0;              ///< up to which the slices have run
  bool stopped_ = false;        ///< no clock
  bool running_ = false;        ///< some slice is enabled
  bool counts_inputs_ = false;  ///< some slice counts or is gated by its pin
  std::uint32_t raised_ = 0;    ///< INTR
  InterruptRegisters interrupts_;
  DreqLines* dreqs_ = nullptr;
  std::uint32_t awaited_ = 0;  ///< slices whose wraps a DMA channel waits for
};

}  // namespace lamplock::sim::chip
