// One PIO block: instruction memory, four state machines, eight interrupt flags, registers
// (RP2040 datasheet, chapter 3).
//
// In:  register accesses; changes of the inputs; clocks, from the PioDmaClock that owns it.
// Out: levels and enables for the pins, changed at the end of a clock and put on the pads at the
//      beginning of the next; the block's two interrupt lines; FIFO levels for the DMA.
// Within a clock machine 0 runs first and 3 last: of writes to one pin the highest number wins
// (3.5.6.1). Flags and FIFO words that a clock has changed are seen in the next.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "sim/chip/fabric/clock_owner.hpp"
#include "sim/chip/fabric/interrupt_registers.hpp"
#include "sim/chip/fabric/irq_lines.hpp"
#include "sim/chip/fabric/peripheral.hpp"
#include "sim/chip/pio/state_machine.hpp"

namespace lamplock::sim::chip {

/// PIO0 or PIO1.
class PioBlock final : public Peripheral {
 public:
  PioBlock(ClockOwner& clock, unsigned number, IrqLines& irqs, NotModelled not_modelled);
  PioBlock(const PioBlock&) = delete;
  PioBlock& operator=(const PioBlock&) = delete;

  // Peripheral
  std::string_view name() const override { return number_ == 0 ? "PIO0" : "PIO1"; }
  std::uint32_t read(std::uint32_t offset) override;
  std::uint32_t peek(std::uint32_t offset) const override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  std::uint32_t write_clear_bits(std::uint32_t offset) const override;
  void reset() override;

  // For the owner of the clock.
  /// Runs one clock.
  void clock(Cycle clock);
  /// The first clock in which the block must run.
  Cycle due() const { return due_; }
  /// Latches that are not on the pads yet, after clock() or a write to a register changed them.
  bool pins_pending() const { return shared_.out != driven_out_ || shared_.dirs != driven_dirs_; }
  std::uint32_t take_levels() { return driven_out_ = shared_.out; }
  std::uint32_t take_enables() { return driven_dirs_ = shared_.dirs; }
  /// The inputs have these levels from cycle `at` on.
  void set_inputs(std::uint32_t levels, Cycle at);
  /// True once after FIFO levels have changed.
  bool take_fifo_changed() { return std::exchange(fifo_changed_, false); }
  void set_every_clock(bool on, Cycle next);
  /// Its clock stops with clock `next` (machines, FIFOs and pins stay), or starts with it.
  void set_clock(bool runs, Cycle next);

  /// Free words of TX FIFO, words of RX FIFO, for the DREQs.
  unsigned tx_space(unsigned machine) const {
    return machines_[machine].tx().depth() - machines_[machine].tx().level();
  }
  unsigned rx_level(unsigned machine) const { return machines_[machine].rx().level(); }

 private:
  /// Clocks of the machines: those of clk_sys without the ones in which the block's clock was
  /// stopped.
  Cycle own(Cycle clock) const { return (stopped_ ? stopped_at_ : clock) - without_; }
  Cycle next_clock() const { return own(owner_.bring_up_to_date()); }
  /// Empty: no register there.
  std::optional<std::uint32_t> value_of(std::uint32_t offset, Cycle next) const;
  std::uint32_t machine_register(std::uint32_t offset, Cycle next) const;
  void write_machine(std::uint32_t offset, std::uint32_t value, Cycle next);
  void write_control(std::uint32_t value, Cycle next);
  void push(unsigned machine, std::uint32_t word, Cycle next);
  void settle(Cycle next);
  void find_due();
  void update_lines();
  void after_change();
  std::uint32_t fstat() const;
  std::uint32_t flevel() const;
  std::uint32_t intr() const;
  void report(const std::string& what) const;

  ClockOwner& owner_;
  unsigned number_;
  IrqLines& irqs_;
  NotModelled not_modelled_;
  pio::Shared shared_;
  std::array<pio::StateMachine, pio::machine_count> machines_;
  Cycle due_ = never_cycle;  ///< of clk_sys
  bool stopped_ = false;     ///< no clock
  Cycle stopped_at_ = 0;     ///< first clock that was missing
  Cycle without_ = 0;        ///< clocks missing before that
  std::uint32_t driven_out_ = 0, driven_dirs_ = 0;
  bool fifo_changed_ = false;
  bool reserved_told_ = false;
  std::array<InterruptRegisters, 2> interrupts_;
};

}  // namespace lamplock::sim::chip
