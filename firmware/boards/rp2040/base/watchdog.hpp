// The watchdog: restarts the chip unless all required interrupts and loops run.
//
// In:  signatures of the e-stop, beat and fill interrupts, of the main loop and of the planner
//      (core 1 after each slice of a plan, the main loop while there is nothing to plan).
// Out: the counter fed, once all five have signed since the last time.
// Who: sign() at any level, on either core (one store); service() from the main loop, every pass.
//
// A watchdog reset restarts everything except the oscillators: pins become inputs, pulled down.
// Without PSM_WDSEL it would reset nothing.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/boards/rp2040/registers/psm.hpp"
#include "firmware/boards/rp2040/registers/watchdog.hpp"

namespace lamplock::rp2040 {

/// HandoutMode that must sign.
enum class Signer : std::uint8_t { estop, beat, fill, main_loop, planner, count };

/// Selects what a restart by the watchdog resets.
inline void select_watchdog_reset() {
  psm().wdsel = psm_bit::all & ~(psm_bit::rosc | psm_bit::xosc);
}

class Watchdog {
 public:
  /// A hundred passes of the main loop. If interrupts hang as well, the ticks have run out long
  /// before.
  static constexpr std::uint32_t timeout_us = 100'000;
  /// The counter has 24 bits.
  static constexpr std::uint32_t max_us = 0xffffff / 2;

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
  /// Before the boot loader, which does not feed the watchdog.
  static void stop() { clear_bits(watchdog_registers().ctrl, watchdog_field::enable); }
  /// The main loop will be busy for this time (an erase of the flash). Valid once, until all have
  /// signed again: a dead interrupt must not stay unnoticed.
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
