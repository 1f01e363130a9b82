// VBUS_DETECT of the USB controller on a pin (RP2040 datasheet, 2.19.2, 4.1.2.7).
//
// In:  levels of the pins that have the function: GPIO 1, 4, 7 ..
// Out: the controller's VBUS level, unless USB_PWR overrides it.
// Who: the chip. OVERCURR_DETECT and VBUS_EN are for a host and not modelled: connected pins keep
//      their level.
#pragma once

#include "sim/chip/gpio/function_pins.hpp"
#include "sim/chip/usb/usb_controller.hpp"

namespace lamplock::sim::chip {

/// Watches the pins for one controller.
class UsbPins final : private FunctionPins::User {
 public:
  UsbPins(Gpio& gpio, UsbController& controller)
      : pins_(gpio, PinFunction::usb, usb_signal), controller_(controller) {
    pins_.listen(*this);
    pins_.sense(vbus_detect);
  }
  UsbPins(const UsbPins&) = delete;
  UsbPins& operator=(const UsbPins&) = delete;

 private:
  static constexpr unsigned vbus_detect = 1;  ///< usb_signal

  void pins_changed(Cycle /*at*/) override {
    if (const bool level = pins_.input(vbus_detect); level != level_) {
      level_ = level;
      controller_.set_vbus_pin(level);
    }
  }

  FunctionPins pins_;
  UsbController& controller_;
  bool level_ = false;
};

}  // namespace lamplock::sim::chip
