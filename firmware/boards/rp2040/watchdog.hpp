// The watchdog: restarts the chip unless everybody who matters is alive.
//
// In:  signatures of the e-stop, beat and fill interrupts, of the main loop and of the planner
//      (core 1 after each slice of a plan, the main loop while there is nothing to plan).
// Out: the counter fed, once all five have signed since the last time.
// Who: sign() at any level, on either core (one store); service() from the main loop, every pass.
//
// A watchdog reset starts everything again but the oscillators: pins become inputs, pulled down.
// Without PSM_WDSEL it would reset nothing.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/boards/rp2040/registers/psm.hpp"
#include "firmware/boards/rp2040/registers/watchdog.hpp"

namespace lamplock::rp2040 {

/// Who has to sign.
enum class Signer : std::uint8_t { estop, beat, fill, main_loop, planner, count };

/// What a restart by the watchdog starts again.
inline void select_watchdog_reset() {
  psm().wdsel = psm_bit::all & ~(psm_bit::rosc | psm_bit::xosc);
}

class Watchdog {
 public:
  /// A hundred passes of the main loop. By then the ticks have run out long ago if interrupts hang
  /// as well.
  static constexpr std::uint32_t timeout_us = 100'000;
  /// The counter has 24 bits.
  static constexpr std::uint32_t longest_us = 0xffffff / 2;

  void start() {
    select_watchdog_reset();
    feed(timeout_us);
    set_bits(watchdog_registers().ctrl, watchdog_field::pause_debug | watchdog_field::enable);
  }
  [[gnu::always_inline]] void sign(Signer who) { signed_[static_cast<std::size_t>(who)] = true; }
  bool has_signed(Signer who) const { return signed_[static_cast<std::size_t>(who)]; }
  void service() {
    for (const volatile bool& one : signed_)
      if (!one) return;
    for (volatile bool& one : signed_) one = false;
    allowed_us_ = 0;
    feed(timeout_us);
  }
  /// Before the boot loader, which feeds nobody.
  static void stop() { clear_bits(watchdog_registers().ctrl, watchdog_field::enable); }
  /// The main loop is going to be busy for so long (an erase of the flash). Once until everybody
  /// has signed again: nothing may stand in for an interrupt that is dead.
  void allow(std::uint32_t us) {
    if (us <= allowed_us_) return;
    allowed_us_ = us;
    feed(us);
  }

 private:
  /// Erratum E1: two counts a tick.
  static void feed(std::uint32_t us) { watchdog_registers().load = 2 * us; }

  std::array<volatile bool, static_cast<std::size_t>(Signer::count)> signed_{};
  std::uint32_t allowed_us_ = 0;  ///< longest time allowed since the last service
};

}  // namespace lamplock::rp2040
