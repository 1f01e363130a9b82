// Erratum RP2040-E5: chips before B2 do not detect the end of a bus reset on a busy bus.
//
// They need 800 us of idle line (J) after the reset, which never occurs after a hub that forwards
// the host's traffic to others, and the device is not found. Work-around: when the reset is over,
// the controller's input is taken from GPIO 15 for 1 ms, which is held at J (D+ high) by its input
// override; the pin's output is off meanwhile. So GPIO 15 is used only for the status LED; a board
// that uses it otherwise (BoardRow::uses_e5_pin) goes without the work-around. Chips from B2 on do
// not need it, and this code does nothing there.
//
// In:  bus resets, `poll` from the main loop at least every millisecond. Out: settings of GPIO 15
//      and of the USB multiplexer. The host waits 10 ms after a reset (USB 2.0, 7.1.7.5); this
//      takes 2 to 4.
#pragma once

#include <cstdint>

#include "firmware/boards/rp2040/registers/usb.hpp"

namespace lamplock::rp2040::usb {

/// The work-around. `Hardware`: status(), microseconds(), hold_idle_line(), release_line().
template <class Hardware>
class BusResetExit {
 public:
  explicit BusResetExit(Hardware& hardware) : hardware_(hardware) {}

  /// `resets`: bus resets counted so far.
  void poll(std::uint32_t resets) {
    if (!hardware_.reset_exit_needed()) return;
    if (resets != seen_) {
      seen_ = resets;
      if (holding_) release();
      waiting_ = true;
    }
    if (waiting_ && line_state() != usb_field::line_state_se0) {
      waiting_ = false;
      holding_ = true;
      since_us_ = hardware_.microseconds();
      hardware_.hold_idle_line();
    } else if (holding_ && hardware_.microseconds() - since_us_ >= hold_us) {
      release();
    }
  }

 private:
  /// More than the 800 us that the controller needs.
  static constexpr std::uint32_t hold_us = 1000;

  std::uint32_t line_state() const {
    return hardware_.status() >> usb_field::line_state_shift & usb_field::line_state_mask;
  }
  void release() {
    holding_ = false;
    hardware_.release_line();
  }

  Hardware& hardware_;
  std::uint32_t seen_ = 0;
  std::uint32_t since_us_ = 0;
  bool waiting_ = false;
  bool holding_ = false;
};

}  // namespace lamplock::rp2040::usb
