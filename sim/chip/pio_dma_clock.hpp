// The clock that PIO0, PIO1 and the DMA share with the cores.
//
// In:  time from the wheel; accesses to their registers (which first bring them up to the present);
//      changes of the pins; DREQs of other blocks.
// Out: pins, interrupt lines, bus accesses of the DMA, in the right cycle and order.
//
// In each clock: levels that the PIO latches took in the clock before appear on the pads; both
// blocks run their machines; the DMA does one write and one read. Machines see in the next clock
// what the DMA or a core writes in this one; what machines push can be read at the end of the
// clock. Clocks in which no part is due are skipped.
//
// So an instruction that executes in cycle c changes its pad in cycle c + 1 (the output latch), and
// a pin that changes in cycle e is seen by the instruction that executes in cycle e + 3
// (input_history.hpp). From an edge at one machine's pin to the edge that another machine puts out
// after waiting for it are 5 cycles (wait 3 after the edge, OUT 4, pad 5).
#pragma once

#include <array>
#include <cstdint>

#include "sim/chip/dma/dma.hpp"
#include "sim/chip/fabric/bus.hpp"
#include "sim/chip/fabric/clock_owner.hpp"
#include "sim/chip/fabric/dreq_lines.hpp"
#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/gpio/gpio.hpp"
#include "sim/chip/pio/pio_block.hpp"

namespace lamplock::sim::chip {

/// Owns both PIO blocks, the DMA and the DREQ lines.
class PioDmaClock final : private Timed,
                          private InputListener,
                          private ClockOwner,
                          private DreqListener {
 public:
  PioDmaClock(TimeWheel& wheel, Bus& bus, Gpio& gpio, IrqLines& irqs, const Timing& timing,
              const NotModelled& not_modelled);
  PioDmaClock(const PioDmaClock&) = delete;
  PioDmaClock& operator=(const PioDmaClock&) = delete;

  PioBlock& pio0() { return pio_[0]; }
  PioBlock& pio1() { return pio_[1]; }
  Dma& dma() { return dma_; }
  /// Requests of the other blocks (UART, SPI, ADC, PWM wrap, XIP).
  DreqLines& dreqs() { return dreqs_; }

  /// Runs every clock of every machine instead of sleeping. Slow; the trace is the same.
  void set_step_every_clock(bool on);
  /// The clock of PIO0 or PIO1, or of the DMA stops or starts.
  void set_pio_clock(std::size_t block, bool runs);
  void set_dma_clock(bool runs);

 private:
  void run(Cycle to) override;
  void inputs_changed(Cycle at) override;
  void catch_up(Cycle at) override;
  Cycle bring_up_to_date() override;
  void changed() override;
  void dreq_pulsed(unsigned dreq) override;
  void dreq_level_changed() override;

  void through(Cycle to, bool by_wheel = false);
  void one_clock(Cycle clock);
  void put_on_pads(Cycle clock);
  Cycle next_due() const;
  void update_wheel();

  TimeWheel& wheel_;
  Gpio& gpio_;
  DreqLines dreqs_;
  std::array<PioBlock, 2> pio_;
  Dma dma_;
  TimeWheel::Slot slot_;
  Cycle next_ = 0;  ///< the first clock that has not been run
  bool running_ = false;
  bool every_clock_ = false;
};

}  // namespace lamplock::sim::chip
