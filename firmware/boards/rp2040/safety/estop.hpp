// The e-stop: everything off within a fraction of a microsecond, independent of all other code.
//
// In:  rising edge of the e-stop pin (normally closed contact: high = pressed or wire broken);
//      after an inverter of the board the falling one.
// Out: FIRE and TICK stopped; Q-switch, trigger, gate, ARM, PWM, shutters and the outputs of
//      programs low; a flag for the main loop, which informs the core and starts the lattice again
//      without motion; the time of the stop, since lamp edges continue until the main loop reacts.
// Who: interrupt() from IO_IRQ_BANK0, alone at priority 0, masked for at most 1 us. Budget: 1.25 us
//      with entry and return. The first 8 of its 16 stores switch all energy off, the last of them
//      64 cycles (0.5 us) after the handler's first instruction; AUX OUT as PWM follows with the
//      next two.
//
// The pads stay low until release_pads(), when the core has left the e-stop state; the trigger's
// until the lattice runs again.
#pragma once

#include <cstdint>

#include "firmware/boards/rp2040/base/program_pins.hpp"
#include "firmware/boards/rp2040/fire/beam_output.hpp"
#include "firmware/boards/rp2040/fire/fire_unit.hpp"
#include "firmware/boards/rp2040/lattice/lattice_output.hpp"
#include "firmware/boards/rp2040/registers/io_bank0.hpp"
#include "firmware/boards/rp2040/registers/timer.hpp"
#include "shared/boards/this_board.hpp"

namespace lamplock::rp2040 {

class Estop {
 public:
  explicit Estop(const FireUnit& fire) : fire_(fire) {}

  /// In the registers of the interrupt: the word, and the bit for the edge that is a press.
  static constexpr unsigned word = io_interrupt::word(boards::gpio(boards::Role::estop));
  static constexpr std::uint32_t edge =
      boards::is_inverted(boards::Role::estop)
          ? io_interrupt::edge_low(boards::gpio(boards::Role::estop))
          : io_interrupt::edge_high(boards::gpio(boards::Role::estop));

  /// Enables the interrupt of the pin. The board enables it at the NVIC.
  void start() const {
    io_bank0().intr[word] = edge;
    set_bits(io_bank0().proc0_inte[word], edge);
  }
  /// Everything off, except for pins that are `kept`.
  [[gnu::always_inline]] void cut(std::uint32_t kept = 0) {
    fire_.cut_off();
    LatticeOutput::freeze();
    if constexpr (has_trigger) force_low(trigger_gpio);
    force_low(boards::gpio(boards::Role::laser_gate));
    force_low(boards::gpio(boards::Role::shot_enable));
    force_low(boards::gpio(boards::Role::laser_pwm));
    BeamOutput::close(kept);
    ProgramPins::end_pwm();
    if (!cut_) cut_us_ = timer().timerawl;
    cut_ = true;
  }
  void interrupt() {
    cut();
    io_bank0().intr[word] = edge;
    seen_ = true;
  }
  /// The lamp continues flashing when the lattice runs again, shots or not.
  static void release_trigger() {
    if constexpr (has_trigger) release(trigger_gpio);
  }
  /// The main loop has not yet handled a cut, or a later press was not yet reported to the core.
  bool is_cut() const { return cut_ || seen_; }
  /// Lower half of the microsecond of the cut.
  std::uint32_t cut_us() const { return cut_us_; }
  bool seen() const { return seen_; }
  void in_order() { cut_ = false; }
  void reported() { seen_ = false; }
  /// Permits energy at the pads again (the fire unit controls ARM, the beam output the gate).
  void release_pads() const {
    release(boards::gpio(boards::Role::q_switch));
    release(boards::gpio(boards::Role::laser_pwm));
  }
  void hold_pads() const {
    force_low(boards::gpio(boards::Role::q_switch));
    force_low(boards::gpio(boards::Role::laser_gate));
    force_low(boards::gpio(boards::Role::laser_pwm));
  }

 private:
  static constexpr bool has_trigger = boards::has(boards::Role::lamp_trigger);
  static constexpr unsigned trigger_gpio = boards::optional_gpio(boards::Role::lamp_trigger);

  const FireUnit& fire_;
  volatile bool cut_ = false;
  volatile std::uint32_t cut_us_ = 0;
  volatile bool seen_ = false;
};

}  // namespace lamplock::rp2040
