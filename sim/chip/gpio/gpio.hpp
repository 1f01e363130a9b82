// The pins of the simulated chip: function select, overrides, pads (RP2040 datasheet, 2.19).
//
// In:  levels and output enables from the peripherals that a pin can be connected to; levels from
//      outside; the registers of IO_BANK0 and PADS_BANK0.
// Out: the levels on the pads, reported to a listener with their cycle; the levels that peripherals
//      see (after pad, INOVER; before any synchroniser); interrupts of IO_BANK0.
//
// A peripheral that is brought up to date in batches (the PIO blocks) drives its pins with the
// cycle at which it did so; the cycles of one source never decrease.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/chip/fabric/irq_lines.hpp"
#include "sim/chip/fabric/peripheral.hpp"
#include "sim/chip/fabric/time_wheel.hpp"

namespace lamplock::sim::chip {

inline constexpr unsigned gpio_count = 30;

/// Function that a pin is connected to (FUNCSEL; 2.19.2).
enum class PinFunction : std::uint8_t {
  spi = 1,
  uart = 2,
  i2c = 3,
  pwm = 4,
  sio = 5,
  pio0 = 6,
  pio1 = 7,
  clock = 8,
  usb = 9,
  none = 31
};

/// Level that the outside drives on a pin.
enum class External : std::uint8_t {
  floating,
  low,
  high,
  pulled_up,  ///< by a resistor that is stronger than the pulls of the pad
};

/// Receives the changes of pad levels.
class PadListener {
 public:
  virtual ~PadListener() = default;
  virtual void pad_changed(unsigned gpio, bool level, Cycle at) = 0;
};
/// Receives changes of the levels that peripherals see (to wake what waits for a pin).
class InputListener {
 public:
  virtual ~InputListener() = default;
  virtual void inputs_changed(Cycle at) = 0;
  /// The pins are about to be read, or their connections to change: a source that is brought up to
  /// date in batches must drive all its changes up to and including cycle `at`.
  virtual void catch_up(Cycle at) { static_cast<void>(at); }
  /// Pins have been connected to other functions (Gpio::selected).
  virtual void connections_changed(Cycle at) { static_cast<void>(at); }
};

/// Receives changes of the pins of one function.
class FunctionListener {
 public:
  virtual ~FunctionListener() = default;
  /// The level that the function sees at one of its pins has changed.
  virtual void inputs_changed(Cycle at) = 0;
  /// A pin is about to be connected to another function: outputs that were on no pin so far must
  /// now be right.
  virtual void connections_changing(Cycle at) = 0;
  /// A pin has been connected to another function.
  virtual void connections_changed(Cycle at) = 0;
};

/// Cycles from a pin to a register of SIO (SYSCFG PROC_IN_SYNC_BYPASS saves "two cycles of input
/// latency", 2.21.2) and, assumed the same, to the interrupt logic of IO_BANK0.
inline constexpr Cycle pin_synchroniser = 2;

/// IO_BANK0, PADS_BANK0 and the pins themselves.
class Gpio : private Timed {
 public:
  Gpio(TimeWheel& wheel, IrqLines& irqs, NotModelled not_modelled);
  Gpio(const Gpio&) = delete;
  Gpio& operator=(const Gpio&) = delete;

  /// The two blocks of registers, for the bus.
  Peripheral& io_bank() { return io_bank_; }
  Peripheral& pads_bank() { return pads_bank_; }

  /// Sets a peripheral's 30 outputs, and which of them it enables.
  void drive(PinFunction from, std::uint32_t levels, std::uint32_t enables, Cycle at) {
    Source& source = sources_[static_cast<std::size_t>(from)];
    const std::uint32_t changed = (levels ^ source.levels) | (enables ^ source.enables);
    if (changed == 0) return;
    source.levels = levels;
    source.enables = enables;
    if ((changed & source.selected) == 0) return;
    take_outputs(source, source.selected);
    update(at);
  }
  /// Sets what the outside drives on a pin.
  void set_external(unsigned gpio, External level, Cycle at);
  /// A permanent wire between two pins: both have one level, and a low wins. Wires add up.
  void join(unsigned one, unsigned other, Cycle at);
  /// Levels that peripherals see at their inputs, before their synchronisers.
  std::uint32_t inputs() const { return inputs_; }
  /// The same as of cycle `at`, which lies at most pin_synchroniser cycles back.
  std::uint32_t inputs_at(Cycle at) const;
  /// Brings all sources up to date.
  void catch_up(Cycle at) {
    for (InputListener* listener : input_listeners_) listener->catch_up(at);
  }
  /// Levels on the pads; a floating pin follows its pull, else keeps its level.
  std::uint32_t pad_levels() const { return pads_; }
  /// Pads that are driven from within, from outside or over a wire; the others follow their pulls.
  std::uint32_t driven() const { return driven_ | external_driven_ | driven_over_wires_; }
  /// Pins that are connected to a function.
  std::uint32_t selected(PinFunction function) const {
    return sources_[static_cast<std::size_t>(function)].selected;
  }

  void listen(PadListener& listener) { pad_listeners_.push_back(&listener); }
  void listen(InputListener& listener) { input_listeners_.push_back(&listener); }
  void listen(FunctionListener& listener, PinFunction to) {
    function_listeners_.push_back({&listener, to});
  }

 private:
  /// What one function puts on the pins, and the pins that are connected to it.
  struct Source {
    std::uint32_t levels = 0;
    std::uint32_t enables = 0;
    std::uint32_t selected = 0;
  };
  /// An override field of all pins (OUTOVER, OEOVER, INOVER, IRQOVER): 1 inverts, 2 low, 3 high.
  struct Override {
    std::uint32_t invert = 0;
    std::uint32_t low = 0;
    std::uint32_t high = 0;
    std::uint32_t apply(std::uint32_t levels) const { return ((levels ^ invert) & ~low) | high; }
    void set(unsigned gpio, std::uint32_t field);
  };
  /// One word of 30 pins for each kind of interrupt, in the order of the registers' bits.
  using Events = std::array<std::uint32_t, 4>;
  enum Event : std::size_t { level_low, level_high, edge_low, edge_high };
  /// PROC0, PROC1, DORMANT_WAKE.
  struct Destination {
    Events enable{};
    Events force{};
  };
  struct Change {
    Cycle at = 0;
    std::uint32_t inputs = 0;
    std::uint32_t interrupt_inputs = 0;
  };

  /// The registers as the bus sees them.
  class IoBank final : public Peripheral {
   public:
    explicit IoBank(Gpio& gpio) : gpio_(gpio) {}
    std::string_view name() const override { return "IO_BANK0"; }
    std::uint32_t read(std::uint32_t offset) override;
    std::uint32_t peek(std::uint32_t offset) const override;
    void write(std::uint32_t offset, std::uint32_t value) override;
    std::uint32_t write_clear_bits(std::uint32_t offset) const override;
    void reset() override;

   private:
    Gpio& gpio_;
  };
  class PadsBank final : public Peripheral {
   public:
    explicit PadsBank(Gpio& gpio) : gpio_(gpio) {}
    std::string_view name() const override { return "PADS_BANK0"; }
    std::uint32_t read(std::uint32_t offset) override;
    std::uint32_t peek(std::uint32_t offset) const override;
    void write(std::uint32_t offset, std::uint32_t value) override;
    std::uint32_t write_clear_bits(std::uint32_t /*offset*/) const override { return 0; }
    void reset() override;

   private:
    Gpio& gpio_;
  };

  void run(Cycle to) override;
  /// What a function puts on these pins, which are connected to it.
  void take_outputs(const Source& source, std::uint32_t pins) {
    out_from_peripheral_ = (out_from_peripheral_ & ~pins) | (source.levels & pins);
    enable_from_peripheral_ = (enable_from_peripheral_ & ~pins) | (source.enables & pins);
  }
  void update(Cycle at);
  void level_wires(std::uint32_t out, std::uint32_t before);
  void report(Cycle at);
  void report_connections(Cycle at);
  void report_contention(std::uint32_t pins);
  void record(Cycle at, std::uint32_t interrupt_inputs);
  void synchronise(Cycle to);
  void update_irq_lines();
  void schedule();

  std::uint32_t io_register(std::uint32_t offset) const;
  std::uint32_t status(unsigned gpio) const;
  Events raw_events() const;
  Events masked_events(const Destination& destination) const;
  void write_control(unsigned gpio, std::uint32_t value);
  void write_pad(unsigned gpio, std::uint32_t value);

  static constexpr std::size_t source_count = 32;  ///< values of FUNCSEL
  static constexpr std::size_t history_size = 8;   ///< changes; the synchronisers need three

  TimeWheel& wheel_;
  TimeWheel::Slot slot_;
  IrqLines& irqs_;
  NotModelled not_modelled_;
  IoBank io_bank_{*this};
  PadsBank pads_bank_{*this};
  std::vector<PadListener*> pad_listeners_;
  std::vector<InputListener*> input_listeners_;
  struct OfFunction {
    FunctionListener* listener;
    PinFunction function;
  };
  std::vector<OfFunction> function_listeners_;

  std::array<Source, source_count> sources_{};
  std::array<std::uint32_t, gpio_count> control_{};
  Override out_override_, enable_override_, input_override_, interrupt_override_;
  std::array<std::uint32_t, gpio_count> pad_control_{};
  std::uint32_t voltage_select_ = 0, swclk_pad_ = 0, swd_pad_ = 0;
  std::uint32_t input_enable_ = 0, output_disable_ = 0, pull_up_ = 0, pull_down_ = 0;
  std::uint32_t external_driven_ = 0, external_high_ = 0, external_pull_up_ = 0;
  std::vector<std::uint32_t> wires_;  ///< pins that are joined
  std::uint32_t driven_over_wires_ = 0;
  std::uint32_t contention_reported_ = 0;

  std::uint32_t out_from_peripheral_ = 0, enable_from_peripheral_ = 0;
  std::uint32_t driven_ = 0;  ///< by the chip
  std::uint32_t pads_ = 0, pads_reported_ = 0;
  std::uint32_t inputs_ = 0, inputs_told_ = 0;

  std::array<Change, history_size> history_{};  ///< a ring; history_last_ is the newest
  std::size_t history_last_ = 0;
  std::size_t unsynchronised_ = 0;  ///< newest changes that the interrupt logic does not see yet
  Cycle due_ = never_cycle;
  std::uint32_t synchronised_ = 0;  ///< levels that the interrupt logic sees
  std::uint32_t edges_low_ = 0, edges_high_ = 0;
  std::array<Destination, 3> destinations_{};
  std::uint32_t watched_ = 0;  ///< pins with an interrupt enabled somewhere
};

}  // namespace lamplock::sim::chip
