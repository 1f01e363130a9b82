// A /sys, a /dev and the kernel's USB calls that the real libusb takes for this computer's, by
// umockdev: the devices of a test, and whatever answers at their nodes.
//
// In:  devices, handlers of calls. Out: what a program sees. Who: tests of libusb_bus, of
//      libusb_stream, of lists of devices.
// It works in programs that run under umockdev's preloaded library alone; CMake sees to that.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

// umockdev's types, which are GObject's and have its names: its header is for C.
// NOLINTBEGIN(bugprone-reserved-identifier)
struct _UMockdevTestbed;
struct _UMockdevIoctlBase;
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
/// The same with a firmware from before the pulse stream had an interface of its own.
EmulatedDevice emulated_old_board();
/// With one HID interface and these numbers.
EmulatedDevice emulated_pendant(std::uint16_t vendor, std::uint16_t product);

/// Answers the kernel's calls at one node.
class CallHandler {
 public:
  virtual ~CallHandler() = default;
  /// `request` of linux/usbdevice_fs.h with its argument, which points into this process. Returns
  /// errno, 0 if the call has done its work, nothing if it is not known. In umockdev's thread.
  virtual std::optional<int> call(unsigned long request, void* argument) = 0;
};

/// One emulated computer.
class EmulatedUsb {
 public:
  EmulatedUsb();
  ~EmulatedUsb();
  EmulatedUsb(const EmulatedUsb&) = delete;
  EmulatedUsb& operator=(const EmulatedUsb&) = delete;

  void add(const EmulatedDevice& device);
  /// As if it were unplugged: whoever has it open keeps its node, nobody else finds it.
  void remove(const EmulatedDevice& device);
  /// Something below an interface of a device: "tty/ttyACM0", with its node in /dev.
  void add_below(const EmulatedDevice& device, unsigned interface, const std::string& subsystem,
                 const std::string& path, const std::string& node);
  /// Calls at the node of a device, plugged in or not yet, are answered by this handler, which must
  /// live for as long as somebody has the node open.
  void attach(const EmulatedDevice& device, CallHandler& handler);
  /// The node of a device that has been added is this file instead: poll() is the file's own.
  void set_node(const EmulatedDevice& device, const std::string& file);
  /// Where a path such as "/dev/ttyACM0" really is.
  std::string real_path(const std::string& path) const;

 private:
  _UMockdevTestbed* testbed_;
  std::vector<_UMockdevIoctlBase*> handlers_;
};

}  // namespace lamplock::usb::test
