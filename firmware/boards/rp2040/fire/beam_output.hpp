// The beam's pins: shutters, attenuator, continuous laser out, photosensors in.
//
// In:  the core's outputs(), edges that the pins have caught.
// Out: SHUTTER 1..4, LASER PWM (62.5 kHz), whether LASER GATE may follow the lattice;
//      photosensors() of the core.
// Who: apply(): beat interrupt (priority 1), and the main loop with it masked, after anything that
//      may have changed outputs(). answered(): beat interrupt, before the results of FIRE are read.
//      close(): any level.
//
// LASER PWM drives the attenuator, or, while the core enables the continuous laser, carries its
// power, which DMA writes with the lattice (laser_pwm.hpp). Without it LASER GATE is held low at
// its pad. When the ticks run out the gate closes; LASER PWM is unchanged up to the restart.
//
// apply() writes the pins only when the outputs have changed; after close() by an e-stop forget()
// makes it write everything again.
//
// The 10 us pulse of a photosensor may be over before it is read: the edge register of the pin
// stores it, interrupt or not, until it is read here at most 100 us later. So an answer may be up
// to 100 us late, or belong to an event up to 100 us before the shot. Maps without these pins have
// one channel, always open, and no photosensor.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/boards/rp2040/base/laser_pwm.hpp"
#include "firmware/boards/rp2040/lattice/lattice_output.hpp"
#include "firmware/boards/rp2040/registers/cortex_m0plus.hpp"
#include "firmware/boards/rp2040/registers/io_bank0.hpp"
#include "firmware/boards/rp2040/registers/pwm.hpp"
#include "firmware/boards/rp2040/registers/sio.hpp"
#include "firmware/machine/controller.hpp"
#include "shared/boards/this_board.hpp"

namespace lamplock::rp2040 {

class BeamOutput {
 public:
  explicit BeamOutput(boards::Pins map) : has_shutters_(boards::channels(map) != 1) {}

  /// Shutters closed, attenuator 0: the pads were inputs before.
  void start() const {
    force_low(pwm_gpio);
    PwmSliceRegisters& slice = pwm().slice[pwm_slice(pwm_gpio)];
    slice.top = laser_pwm_counts - 1;
    slice.cc = 0;
    slice.csr = pwm_csr::enable;
    set_function(pwm_gpio, io_ctrl::Function::pwm);
    close();
    if (!with_shutters || !has_shutters_) return;
    sio().gpio_oe_set = all_shutters;
    for (unsigned gpio = first_shutter; gpio < first_shutter + channels; ++gpio)
      set_function(gpio, io_ctrl::Function::sio);
  }
  /// One store (e-stop, priority 0), except for pins that are `kept`. With the shutters it switches
  /// the pins of programs and Z ENABLE off (program_pins.hpp). In another map some of them may be
  /// the UART's, which the store does not affect.
  [[gnu::always_inline]] static void close(std::uint32_t kept = 0) {
    sio().gpio_out_clr = switched_pins & ~kept;
  }

  /// `is_cut()`: an e-stop has closed everything and is not handled yet.
  template <class IsCut>
  void apply(const machine::Outputs& outputs, IsCut&& is_cut) {
    const std::uint32_t wanted = (outputs.laser_enable ? laser_enabled : 0) |
                                 std::uint32_t{outputs.attenuator} << 8 | outputs.shutters;
    if (wanted == applied_) return;
    const AllMasked masked;  // an e-stop in between would be undone
    if (is_cut()) return;
    applied_ = wanted;
    if (with_shutters && has_shutters_) {
      const std::uint32_t open = std::uint32_t{outputs.shutters} << first_shutter & all_shutters;
      sio().gpio_out_clr = all_shutters & ~open;
      sio().gpio_out_set = open;
    }
    // Off at the pad first: then the lattice bit has no effect outside.
    if (!outputs.laser_enable) force_low(gate_gpio);
    LatticeOutput::connect_power(outputs.laser_enable);
    put_duty(outputs.laser_enable ? std::uint16_t{0} : outputs.attenuator);
    if (outputs.laser_enable) release(gate_gpio);
  }

  /// Sets the phase of LASER PWM in its period.
  static void set_count(std::uint32_t count) { pwm().slice[pwm_slice(pwm_gpio)].ctr = count; }

  /// Another function may have switched the pins off.
  void forget() { applied_ = nothing; }

  /// Photosensors that have answered since the last call.
  std::uint8_t answered() const {
    if (!with_shutters || !has_shutters_ || !any_answer()) return 0;
    std::uint8_t bits = 0;
    for (unsigned i = 0; i < channels; ++i) {
      const std::uint32_t edge = io_interrupt::edge_high(sensors[i]);
      Register& caught = io_bank0().intr[io_interrupt::word(sensors[i])];
      if ((caught & edge) == 0) continue;
      caught = edge;
      bits = static_cast<std::uint8_t>(bits | 1u << i);
    }
    return bits;
  }

 private:
  static constexpr unsigned channels = 4;
  static constexpr unsigned pwm_gpio = boards::gpio(boards::Role::laser_pwm);
  static constexpr unsigned gate_gpio = boards::gpio(boards::Role::laser_gate);
  static constexpr bool with_shutters = boards::has(boards::Role::shutter_1);
  static constexpr unsigned first_shutter = boards::optional_gpio(boards::Role::shutter_1);
  static constexpr std::uint32_t all_shutters =
      boards::any_of(boards::Role::shutter_1, boards::Role::shutter_2, boards::Role::shutter_3,
                     boards::Role::shutter_4);
  static constexpr std::uint32_t switched_pins =
      all_shutters |
      boards::any_of(boards::Role::air, boards::Role::aux_out, boards::Role::z_enable);
  static constexpr std::array<unsigned, channels> sensors{
      boards::optional_gpio(boards::Role::photosensor_1),
      boards::optional_gpio(boards::Role::photosensor_2),
      boards::optional_gpio(boards::Role::photosensor_3),
      boards::optional_gpio(boards::Role::photosensor_4)};

  static_assert(io_interrupt::word(sensors[0]) == io_interrupt::word(sensors[1]) &&
                io_interrupt::word(sensors[2]) == io_interrupt::word(sensors[3]));
  static bool any_answer() {
    const auto edges = [](unsigned first) {
      return io_bank0().intr[io_interrupt::word(sensors[first])] &
             (io_interrupt::edge_high(sensors[first]) |
              io_interrupt::edge_high(sensors[first + 1]));
    };
    return (edges(0) | edges(2)) != 0;
  }

  static void put_duty(std::uint16_t value) {
    pwm().slice[pwm_slice(pwm_gpio)].cc = std::uint32_t{laser_duty(value)} << pwm_shift(pwm_gpio);
  }
  /// Keeps the overrides of the pad.
  static void set_function(unsigned gpio, io_ctrl::Function function) {
    Register& ctrl = io_bank0().gpio[gpio].ctrl;
    ctrl = (ctrl & ~io_ctrl::function_mask) | io_ctrl::function(function);
  }

  static constexpr std::uint32_t nothing = ~0u;  ///< no set of outputs
  static constexpr std::uint32_t laser_enabled = 1u << 24;

  std::uint32_t applied_ = nothing;  ///< at the pins: laser enabled, attenuator, shutters
  const bool has_shutters_;
};

}  // namespace lamplock::rp2040
