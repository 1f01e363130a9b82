// Pins of programs, AUX OUT and AIR, and Z ENABLE, which is not a program's but is next to them.
//
// In:  the core's switched_outputs().
// Out: AUX OUT: low, high, or PWM (62.5 kHz, as LASER PWM; a low-pass converts it to a voltage).
//      AIR. Z ENABLE: its pad inverts the level unless $4 means active high, so that low at the
//      peripheral is off for all of them.
// Who: apply(): beat interrupt, when the lattice has reached a change, and the main loop with it
//      masked. The e-stop interrupt switches all of them off with the shutters, whose pins they are
//      in another map (BeamOutput::close()), and AUX OUT as PWM by end_pwm().
//
// Writes the pins only when the outputs have changed. Maps have all of these pins, only AIR, or
// none.
#pragma once

#include <cstdint>

#include "firmware/boards/rp2040/base/laser_pwm.hpp"
#include "firmware/boards/rp2040/registers/cortex_m0plus.hpp"
#include "firmware/boards/rp2040/registers/io_bank0.hpp"
#include "firmware/boards/rp2040/registers/pwm.hpp"
#include "firmware/boards/rp2040/registers/sio.hpp"
#include "firmware/machine/controller.hpp"
#include "shared/boards/pico_pins.hpp"

namespace lamplock::rp2040 {

class ProgramPins {
 public:
  explicit ProgramPins(boards::PinMap map)
      : has_air_(boards::find_gpio(map, boards::Role::air).has_value()),
        has_aux_(boards::find_gpio(map, boards::Role::aux_out).has_value()) {}

  /// All off: the pads were inputs before.
  [[gnu::cold]] void start(bool enable_active_high) const {
    sio().gpio_out_clr = pins();
    sio().gpio_oe_set = pins();
    if (has_air_) io_bank0().gpio[air_gpio].ctrl = io_ctrl::function(io_ctrl::Function::sio);
    if (!has_aux_) return;
    PwmSliceRegisters& slice = pwm().slice[pwm_slice(aux_gpio)];
    slice.top = laser_pwm_counts - 1;
    slice.cc = 0;
    slice.csr = pwm_csr::enable;
    io_bank0().gpio[aux_gpio].ctrl = io_ctrl::function(io_ctrl::Function::sio);
    io_bank0().gpio[z_gpio].ctrl = io_ctrl::function(io_ctrl::Function::sio) |
                                   (enable_active_high ? 0 : io_ctrl::output_inverted);
  }

  /// The map has at least one of these pins.
  bool any() const { return has_air_; }
  /// `is_cut()`: an e-stop has switched everything off and is not handled yet.
  template <class IsCut>
  void apply(const machine::SwitchedOutputs& outputs, IsCut&& is_cut) {
    const std::uint32_t wanted =
        (outputs.z_enable ? z_wanted : 0) | (outputs.air ? air_wanted : 0) | outputs.aux;
    if (wanted == applied_) return;
    const AllMasked masked;  // an e-stop in between would be undone
    if (is_cut()) return;
    applied_ = wanted;
    put(outputs);
  }
  /// AUX OUT low in PWM, too (e-stop, priority 0): the compare value takes effect at the next wrap,
  /// which is due with the next clock, and until then the counter is above it. Other maps do not
  /// use this slice.
  [[gnu::always_inline]] static void end_pwm() {
    PwmSliceRegisters& slice = pwm().slice[pwm_slice(aux_gpio)];
    slice.cc = 0;
    slice.ctr = laser_pwm_counts - 1;
  }
  /// Pins that stay on when the machine stops dead without an e-stop: a vertical Z would drop.
  std::uint32_t of_drives() const { return has_aux_ ? 1u << z_gpio : 0; }
  /// Another function may have switched the pins off.
  void forget() { applied_ = nothing; }

 private:
  static constexpr unsigned air_gpio =
      *boards::find_gpio(boards::PinMap::cut_io, boards::Role::air);
  static_assert(air_gpio == *boards::find_gpio(boards::PinMap::cut, boards::Role::air));
  static constexpr unsigned aux_gpio =
      *boards::find_gpio(boards::PinMap::cut_io, boards::Role::aux_out);
  static_assert(pwm_slice(aux_gpio) != pwm_slice(boards::gpio(boards::Role::laser_pwm)));
  static constexpr unsigned z_gpio =
      *boards::find_gpio(boards::PinMap::cut_io, boards::Role::z_enable);
  static constexpr std::uint32_t nothing = ~0u;  ///< no set of outputs
  static constexpr std::uint32_t z_wanted = 1u << 17, air_wanted = 1u << 16, full = 65535;

  std::uint32_t pins() const {
    return (has_air_ ? 1u << air_gpio : 0) | (has_aux_ ? 1u << aux_gpio | 1u << z_gpio : 0);
  }
  [[gnu::noinline]] void put(const machine::SwitchedOutputs& outputs) const {
    // Values between off and on are PWM; both ends are levels, which change at once.
    const bool is_pwm = has_aux_ && outputs.aux != 0 && outputs.aux != full;
    const std::uint32_t high = (outputs.aux == full ? 1u << aux_gpio : 0) |
                               (outputs.air ? 1u << air_gpio : 0) |
                               (outputs.z_enable ? 1u << z_gpio : 0);
    sio().gpio_out_clr = pins() & ~high;
    sio().gpio_out_set = pins() & high;
    if (!has_aux_) return;
    pwm().slice[pwm_slice(aux_gpio)].cc = std::uint32_t{laser_duty(outputs.aux)}
                                          << pwm_shift(aux_gpio);
    io_bank0().gpio[aux_gpio].ctrl =
        io_ctrl::function(is_pwm ? io_ctrl::Function::pwm : io_ctrl::Function::sio);
  }

  std::uint32_t applied_ = nothing;  ///< at the pins
  const bool has_air_, has_aux_;
};

}  // namespace lamplock::rp2040
