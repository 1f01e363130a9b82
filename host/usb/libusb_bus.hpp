// The USB devices of this computer, by libusb-1.0.
//
// In:  requests. Out: descriptors, bytes, what became of transfers.
// Who: commands that use a device; they see usb::Bus alone.
//
// Polite: a device is opened only when asked for (texts come from /sys), no driver is taken off an
// interface, nothing is reset. Where there is no USB, as in many containers, there are no devices.
#pragma once

#include <libusb-1.0/libusb.h>

#include <chrono>
#include <memory>
#include <vector>

#include "host/usb/sysfs.hpp"
#include "host/usb/usb.hpp"

namespace lamplock::usb {

class LibusbBus final : public Bus {
 public:
  LibusbBus();

  std::vector<DeviceInfo> devices() override;
  std::unique_ptr<Device> open(const DeviceInfo& device) override;
  /// Real time.
  void sleep(std::chrono::milliseconds time) override;
  std::chrono::milliseconds now() override;

 private:
  /// Null without USB. Devices keep it too: they may outlive the bus.
  std::shared_ptr<libusb_context> context_;
  Sysfs sysfs_;
};

}  // namespace lamplock::usb
