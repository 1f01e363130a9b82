// A /sys, a /dev and the kernel's USB calls that the real libusb takes for this computer's, by
// umockdev: the devices of a test, and a loader model behind one of them.
//
// In:  devices. Out: what a program sees. Who: tests of libusb_bus, of lists of devices.
// It works in programs that run under umockdev's preloaded library alone; CMake sees to that.
#pragma once

#include <linux/usbdevice_fs.h>

#include <deque>
#include <map>
#include <memory>
#include <string>

#include "tests/flash/loader_model.hpp"

// umockdev's types, which are GObject's and have its names: its header is for C.
// NOLINTBEGIN(bugprone-reserved-identifier)
struct _UMockdevTestbed;
struct _UMockdevIoctlBase;
struct _UMockdevIoctlClient;
// NOLINTEND(bugprone-reserved-identifier)

namespace lamplock::usb::test {

/// False where the library is not preloaded: the test is to be skipped.
bool can_be_emulated();

/// A device as the kernel shows it.
struct EmulatedDevice {
  std::string place = "1-4";
  unsigned address = 5;     ///< on bus 1
  std::string descriptors;  ///< device and configuration, hexadecimal
  std::string manufacturer, product, serial;
};

/// Descriptors of a boot loader with its drive (RP2040 datasheet, 2.8.5.1, 2.8.5.2).
EmulatedDevice emulated_loader();
/// Those of a board that runs lamplock, of its own tables.
EmulatedDevice emulated_board();
/// With one HID interface and these numbers.
EmulatedDevice emulated_pendant(std::uint16_t vendor, std::uint16_t product);

/// One emulated computer.
class EmulatedUsb {
 public:
  EmulatedUsb();
  ~EmulatedUsb();
  EmulatedUsb(const EmulatedUsb&) = delete;
  EmulatedUsb& operator=(const EmulatedUsb&) = delete;

  void add(const EmulatedDevice& device);
  /// Something below an interface of a device: "tty/ttyACM0", with its node in /dev.
  void add_below(const EmulatedDevice& device, unsigned interface, const std::string& subsystem,
                 const std::string& path, const std::string& node);
  /// Transfers to a device go to this model, which must outlive the emulation.
  void attach(const EmulatedDevice& device, flash::test::LoaderModel& model);
  /// Where a path such as "/dev/ttyACM0" really is.
  std::string real_path(const std::string& path) const;

  /// A call of the kernel; false: not known.
  bool call(_UMockdevIoctlClient* client);

 private:
  void submit(usbdevfs_urb& urb);

  _UMockdevTestbed* testbed_;
  _UMockdevIoctlBase* handler_ = nullptr;
  flash::test::LoaderModel* model_ = nullptr;
  std::deque<usbdevfs_urb*> done_, waiting_;
};

}  // namespace lamplock::usb::test
