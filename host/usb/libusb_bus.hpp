// The USB devices of this computer, by libusb-1.0.
//
// In:  requests. Out: descriptors, bytes, results of transfers.
// Who: commands that use a device, through usb::Bus.
//
// A device is opened only on request (texts come from /sys), no driver is detached from an
// interface, no device is reset. Without USB, as in many containers, the list of devices is empty.
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
  /// Null without USB. Devices share it: they may outlive the bus.
  std::shared_ptr<libusb_context> context_;
  Sysfs sysfs_;
};

}  // namespace lamplock::usb
