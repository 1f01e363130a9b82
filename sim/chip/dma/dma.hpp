// The DMA: twelve channels, one read and one write of the bus in each clock (RP2040
// datasheet, 2.5).
//
// In:  register accesses; requests of the PIO FIFOs and of DreqLines; clocks, from PioDmaClock.
// Out: bus accesses as Master::dma; interrupt lines DMA_IRQ_0 and 1.
//
// One transfer: a request (trigger, or a credit for a DREQ), the read Timing::dma_start clocks
// later, the write in the clock after the read (and its wait states). Reads continue while writes
// lag, up to the depth of the data FIFO.
// Credits (2.5.3.2): for each transfer that a FIFO can take or give and that no credit covers yet,
// one credit a clock; a channel spends one with each read. They are cleared when a channel starts.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "sim/chip/dma/sniffer.hpp"
#include "sim/chip/fabric/bus.hpp"
#include "sim/chip/fabric/clock_owner.hpp"
#include "sim/chip/fabric/dreq_lines.hpp"
#include "sim/chip/fabric/interrupt_registers.hpp"
#include "sim/chip/fabric/irq_lines.hpp"
#include "sim/chip/fabric/peripheral.hpp"
#include "sim/chip/fabric/timing.hpp"
#include "sim/chip/pio/pio_block.hpp"

namespace lamplock::sim::chip {

inline constexpr unsigned dma_channel_count = 12;
inline constexpr unsigned dma_timer_count = 4;

class Dma final : public Peripheral {
 public:
  Dma(ClockOwner& clock, Bus& bus, DreqLines& dreqs, const std::array<PioBlock, 2>& pio,
      IrqLines& irqs, const Timing& timing, NotModelled not_modelled);
  Dma(const Dma&) = delete;
  Dma& operator=(const Dma&) = delete;

  // Peripheral
  std::string_view name() const override { return "DMA"; }
  std::uint32_t read(std::uint32_t offset) override;
  std::uint32_t peek(std::uint32_t offset) const override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  std::uint32_t write_clear_bits(std::uint32_t offset) const override;
  void reset() override;

  // For the owner of the clock.
  void clock(Cycle clock);
  Cycle due() const { return due_; }
  /// The level of a FIFO has changed: channels that it paces check it in `clock`.
  void levels_changed(Cycle clock);
  /// A request without a FIFO, in `clock`.
  void pulse(unsigned dreq, Cycle clock);
  /// Its clock stops with clock `next` and all state stays, or it starts again with that clock.
  void set_clock(bool runs, Cycle next);
  /// True if no transfers remain on any channel.
  bool idle() const { return busy_mask_ == 0 && fifo_level_ == 0; }
  /// Called from inside clocks that end with idle(); may be empty.
  std::function<void()> on_idle;

 private:
  struct Channel {
    std::uint32_t read_address = 0, write_address = 0;
    std::uint32_t reload = 0;   ///< TRANS_COUNT of the next sequence
    std::uint32_t count = 0;    ///< remaining writes
    std::uint32_t to_read = 0;  ///< remaining reads
    std::uint32_t control = 0;  ///< without BUSY and errors
    bool busy = false, read_error = false, write_error = false, aborting = false;
    std::uint32_t in_flight = 0;  ///< read and not yet written
    std::uint32_t credits = 0;
    std::uint64_t arriving = 0;  ///< bit n: a credit that counts from clock now_ + n on
    Cycle ready = 0;             ///< first clock in which it may read
    bool high_priority() const { return (control & 2u) != 0; }
    bool enabled() const { return (control & 1u) != 0; }
    unsigned treq() const { return control >> 15 & 0x3fu; }
    unsigned chain_to() const { return control >> 11 & 0xfu; }
    bool quiet() const { return (control >> 21 & 1u) != 0; }
    unsigned size_shift() const { return std::min(2u, control >> 2 & 3u); }
  };
  /// A pacing timer: adds X each clock, a request at each Y.
  struct Timer {
    std::uint32_t x = 0, y = 0, sum = 0;
  };
  struct InFlight {
    std::uint8_t channel = 0;
    std::uint32_t data = 0;
    Cycle ready = 0;
  };

  void advance_to(Cycle clock);
  void give_back();
  void write_phase(Cycle clock);
  void read_phase(Cycle clock);
  void stop(unsigned channel);
  void finish(unsigned channel, Cycle clock);
  void trigger(unsigned channel, Cycle clock);
  void trigger_written(unsigned channel, std::uint32_t value, Cycle clock);
  void abort(unsigned channel);
  bool wants_read(const Channel& channel, Cycle clock) const;
  unsigned choose(Cycle clock);
  unsigned available(unsigned dreq) const;
  unsigned owed(const Channel& channel) const;
  std::uint32_t next_address(const Channel& channel, std::uint32_t address, bool write) const;
  std::uint32_t aligned(std::uint32_t address, const Channel& channel);
  void raise(unsigned channel);
  void update_lines();
  void find_due(Cycle clock, bool gives_credits = false);
  std::uint32_t control_of(const Channel& channel) const;
  void set_control(Channel& channel, std::uint32_t value);
  void write_channel(std::uint32_t offset, std::uint32_t value, Cycle clock);
  void write_global(std::uint32_t offset, std::uint32_t value, Cycle clock);
  /// Empty: no register there.
  std::optional<std::uint32_t> value_of(std::uint32_t offset) const;
  std::optional<std::uint32_t> global_value(std::uint32_t offset) const;
  void report(const std::string& what) const;

  ClockOwner& owner_;
  Bus& bus_;
  DreqLines& dreqs_;
  const std::array<PioBlock, 2>& pio_;
  IrqLines& irqs_;
  const Timing& timing_;
  NotModelled not_modelled_;

  std::array<Channel, dma_channel_count> channels_{};
  std::array<Timer, dma_timer_count> timers_{};
  Sniffer sniffer_;
  std::array<InterruptRegisters, 2> interrupts_;
  std::uint32_t raised_ = 0;  ///< INTR
  std::uint32_t busy_mask_ = 0;

  /// Depth of the transfer data FIFO (assumed; FIFO_LEVELS does not say).
  static constexpr unsigned fifo_depth = 4;
  std::array<InFlight, fifo_depth> fifo_{};
  unsigned fifo_head_ = 0, fifo_level_ = 0;
  Cycle read_free_ = 0, write_free_ = 0;
  std::uint32_t high_served_ = 0;  ///< high-priority channels that had their turn in this round
  unsigned last_low_ = dma_channel_count - 1, last_high_ = dma_channel_count - 1;
  Cycle now_ = 0;  ///< credits and timers are up to date through this clock
  Cycle due_ = never_cycle;
  bool stopped_ = false;  ///< no clock
  Cycle stopped_at_ = 0;  ///< first clock that it did not have
};

}  // namespace lamplock::sim::chip
