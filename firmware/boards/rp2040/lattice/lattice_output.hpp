// The hardware of the lattice: state machines AXIS, BITS, TICK, STAMP and their DMA.
//
// In:  rings; commands to start and to freeze.
// Out: steps, lattice bits, tick line; the number of ticks begun when frozen.
// Who: start(), prepare(), go(), ticks_begun(): main loop with beat and fill interrupts masked.
//      freeze(): any level (e-stop interrupt: one store). stamps(): beat and edge interrupt too.
//      Functions outside this header are not time-critical and run from flash.
//
// DMA channels read their rings continuously by address wrap. A channel counts to 2^32 - 1 and
// would then stop (TICK after more than an hour): each is chained to one small channel that
// triggers all of them; running channels ignore that (datasheet, 2.5.2.1). Their counts differ, so
// that no two end together. BITS ends after each cell of ticks and starts the channel of LASER PWM,
// which writes a count and starts BITS again (laser_pwm.hpp). While the continuous laser is not
// enabled it writes to a slice of the PWM that has no pin.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/boards/rp2040/base/allocation.hpp"
#include "firmware/boards/rp2040/lattice/lattice_rings.hpp"
#include "firmware/boards/rp2040/lattice/stamp_reader.hpp"
#include "firmware/boards/rp2040/lattice/tick_feed.hpp"
#include "firmware/boards/rp2040/pio/assembler.hpp"
#include "firmware/boards/rp2040/registers/dma.hpp"
#include "firmware/boards/rp2040/registers/pio.hpp"
#include "firmware/boards/rp2040/registers/pwm.hpp"
#include "firmware/stepper/pulse_output.hpp"
#include "shared/boards/this_board.hpp"

namespace lamplock::rp2040 {

class LatticeOutput {
 public:
  LatticeOutput(LatticeRings& rings, PowerRing& power, TickRing& ticks, StampRing& stamps)
      : rings_(rings), power_(power), ticks_(ticks), stamps_(stamps) {}

  /// Sets pins low, then their function, then loads programs. Nothing runs. PIO, DMA, pads out of
  /// reset.
  void start(boards::Pins map, const stepper::PulseOutput& output);
  /// Other times of pulses, while no step is in the rings.
  void set_times(const PulseTimes& times);
  /// Resets everything, fills FIFOs from the rings; AXIS and BITS wait for the first tick.
  void prepare();
  /// TICK and STAMP start together with this store.
  [[gnu::always_inline]] static void go() {
    const std::uint32_t both = tick_machine.mask() | stamp_machine.mask();
    set_bits(pio1().ctrl, pio_ctrl::enable(both) | pio_ctrl::clkdiv_restart(both));
  }
  /// Last output of AXIS, without inversions: bit 0 the first pin of the axis, bit 1 the second.
  static std::uint8_t levels(int axis);
  /// No further tick: TICK stops in place. A pulse that is high stays high until prepare(), so that
  /// no step counted by ticks_begun() is cut short. Lattice bits do not change: hold them at the
  /// pads.
  [[gnu::always_inline]] static void freeze() {
    clear_bits(pio1().ctrl, pio_ctrl::enable(1u << tick_number));
  }
  /// Frozen: ticks that have begun since power-up, all of which AXIS has output.
  std::uint64_t ticks_begun(const TickFeed& feed) const;
  /// Stamps written so far, modulo the ring.
  [[gnu::always_inline]] std::uint32_t stamps() const {
    const std::uintptr_t begin = reinterpret_cast<std::uintptr_t>(stamps_.words.data());
    return (dma().ch[stamp_channel].write_addr - static_cast<std::uint32_t>(begin)) / 4;
  }
  /// From the next cell on power goes to LASER PWM, or to no pin, which is the state after
  /// prepare(). Meanwhile the caller owns the slice of LASER PWM.
  static void connect_power(bool to_pin) {
    dma().ch[power_channel].write_addr = power_address(to_pin);
  }
  /// Selects the pin of LAMP SYNC.
  void use_sync(unsigned gpio) const;

 private:
  /// A slice whose pins have other functions: neither that of LASER PWM nor that of AUX OUT.
  static constexpr unsigned unused_slice = [] {
    const auto aux = boards::find_gpio(boards::this_board, boards::Role::aux_out);
    unsigned slice = 7;
    while (slice == pwm_slice(boards::gpio(boards::Role::laser_pwm)) ||
           (aux && slice == pwm_slice(*aux)))
      --slice;
    return slice;
  }();
  static std::uint32_t power_address(bool to_pin) {
    const unsigned slice = to_pin ? pwm_slice(boards::gpio(boards::Role::laser_pwm)) : unused_slice;
    return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(&pwm().slice[slice].cc));
  }
  static constexpr unsigned tick_number = 2;  ///< of TICK in PIO1
  void start_axis(int axis, const stepper::AxisPulses& pulses) const;
  std::uint32_t axis_pins(int axis) const;
  const pio::Program& program_of_axes() const;
  void change_program(bool was_long) const;
  void start_pins() const;
  void start_channels();
  void start_bits() const;

  LatticeRings& rings_;
  PowerRing& power_;
  TickRing& ticks_;
  StampRing& stamps_;
  /// In SRAM, because DMA reads it while the flash is written. Volatile: the compiler does not see
  /// the read.
  volatile std::uint32_t again_mask_ = 0;
  int axes_ = 3;  ///< axes that have pins
  PerAxis<settings::PulseMode> modes_{};
  PulseTimes times_;
};

}  // namespace lamplock::rp2040
