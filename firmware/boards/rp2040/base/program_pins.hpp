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
// Writes the pins only when the outputs have changed. A map has any of these pins, or none.
#pragma once

#include <cstdint>

#include "firmware/boards/rp2040/base/laser_pwm.hpp"
#include "firmware/boards/rp2040/registers/cortex_m0plus.hpp"
#include "firmware/boards/rp2040/registers/io_bank0.hpp"
#include "firmware/boards/rp2040/registers/pwm.hpp"
#include "firmware/boards/rp2040/registers/sio.hpp"
#include "firmware/machine/controller.hpp"
#include "shared/boards/this_board.hpp"

namespace lamplock::rp2040 {

class ProgramPins {
 public:
  explicit ProgramPins(boards::Pins map)
      : air_(boards::pin_of(map, boards::Role::air)),
        aux_(boards::pin_of(map, boards::Role::aux_out)),
        z_(boards::pin_of(map, boards::Role::z_enable)) {}

  /// All off: the pads were inputs before.
  [[gnu::cold]] void start(bool enable_active_high) const {
    sio().gpio_out_clr = pins();
    sio().gpio_oe_set = pins();
    if (air_ != 0) io_bank0().gpio[air_gpio].ctrl = io_ctrl::function(io_ctrl::Function::sio);
    if (z_ != 0)
      io_bank0().gpio[z_gpio].ctrl = io_ctrl::function(io_ctrl::Function::sio) |
                                     (enable_active_high ? 0 : io_ctrl::output_inverted);
    if (aux_ == 0) return;
    PwmSliceRegisters& slice = pwm().slice[pwm_slice(aux_gpio)];
    slice.top = laser_pwm_counts - 1;
    slice.cc = 0;
    slice.csr = pwm_csr::enable;
    io_bank0().gpio[aux_gpio].ctrl = io_ctrl::function(io_ctrl::Function::sio);
  }

  /// The map has at least one of these pins.
  bool any() const { return pins() != 0; }
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
    if constexpr (!boards::has(boards::Role::aux_out)) return;
    PwmSliceRegisters& slice = pwm().slice[pwm_slice(aux_gpio)];
    slice.cc = 0;
    slice.ctr = laser_pwm_counts - 1;
  }
  /// Pins that stay on when the machine stops dead without an e-stop: a vertical Z would drop.
  std::uint32_t of_drives() const { return z_; }
  /// Another function may have switched the pins off.
  void forget() { applied_ = nothing; }

 private:
  static constexpr unsigned air_gpio = boards::optional_gpio(boards::Role::air);
  static constexpr unsigned aux_gpio = boards::optional_gpio(boards::Role::aux_out);
  static constexpr unsigned z_gpio = boards::optional_gpio(boards::Role::z_enable);
  static constexpr std::uint32_t nothing = ~0u;  ///< no set of outputs
  static constexpr std::uint32_t z_wanted = 1u << 17, air_wanted = 1u << 16, full = 65535;

  std::uint32_t pins() const { return air_ | aux_ | z_; }
  [[gnu::noinline]] void put(const machine::SwitchedOutputs& outputs) const {
    // Values between off and on are PWM; both ends are levels, which change at once.
    const bool is_pwm = aux_ != 0 && outputs.aux != 0 && outputs.aux != full;
    const std::uint32_t high =
        (outputs.aux == full ? aux_ : 0) | (outputs.air ? air_ : 0) | (outputs.z_enable ? z_ : 0);
    sio().gpio_out_clr = pins() & ~high;
    sio().gpio_out_set = high;
    if (aux_ == 0) return;
    pwm().slice[pwm_slice(aux_gpio)].cc = std::uint32_t{laser_duty(outputs.aux)}
                                          << pwm_shift(aux_gpio);
    io_bank0().gpio[aux_gpio].ctrl =
        io_ctrl::function(is_pwm ? io_ctrl::Function::pwm : io_ctrl::Function::sio);
  }

  std::uint32_t applied_ = nothing;    ///< at the pins
  const std::uint32_t air_, aux_, z_;  ///< the pin of each as a bit; 0: the map has none
};

}  // namespace lamplock::rp2040
