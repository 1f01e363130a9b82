// A /sys, a /dev and the kernel's USB calls that the real libusb sees as this computer's, emulated
// by umockdev: the devices of a test, and handlers of calls at their nodes.
//
// In:  devices, handlers of calls. Out: what a program sees. Who: tests of libusb_bus, of
//      libusb_stream, of lists of devices.
// It works only in programs that run under umockdev's preloaded library, as set up by CMake.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

// umockdev's types are GObject types with reserved names; its header is for C.
// NOLINTBEGIN(bugprone-reserved-identifier)
struct _UMockdevTestbed;
struct _UMockdevIoctlBase;
// NOLINTEND(bugprone-reserved-identifier)

namespace lamplock::usb::test {

/// False if the library is not preloaded; the test must then be skipped.
bool can_be_emulated();

/// A device as the kernel presents it.
struct EmulatedDevice {
  std::string place = "1-4";
  unsigned address = 5;     ///< on bus 1
  std::string descriptors;  ///< device and configuration, hexadecimal
  std::string manufacturer, product, serial;
};

/// Descriptors of a boot loader with its drive (RP2040 datasheet, 2.8.5.1, 2.8.5.2).
EmulatedDevice emulated_loader();
/// Descriptors of a board that runs lamplock, from its own tables.
EmulatedDevice emulated_board();
/// The same with an old firmware whose pulse stream has no interface of its own.
EmulatedDevice emulated_old_board();
/// A device with one HID interface and these numbers.
EmulatedDevice emulated_pendant(std::uint16_t vendor, std::uint16_t product);

/// Answers the kernel's calls at one node.
class CallHandler {
 public:
  virtual ~CallHandler() = default;
  /// `request` of linux/usbdevice_fs.h with its argument, which points into this process. Returns
  /// errno, 0 if the call was executed, nothing if it is unknown. Runs in umockdev's thread.
  virtual std::optional<int> call(unsigned long request, void* argument) = 0;
};

class EmulatedUsb {
 public:
  EmulatedUsb();
  ~EmulatedUsb();
  EmulatedUsb(const EmulatedUsb&) = delete;
  EmulatedUsb& operator=(const EmulatedUsb&) = delete;

  void add(const EmulatedDevice& device);
  /// Unplugs a device: a program that has it open keeps its node, other programs do not find it.
  void remove(const EmulatedDevice& device);
  /// Adds a child below an interface of a device: "tty/ttyACM0", with its node in /dev.
  void add_below(const EmulatedDevice& device, unsigned interface, const std::string& subsystem,
                 const std::string& path, const std::string& node);
  /// Calls at the node of a device, plugged in or not, are answered by this handler, which must
  /// live for as long as a program has the node open.
  void attach(const EmulatedDevice& device, CallHandler& handler);
  /// Replaces the node of an added device by this file: poll() is the file's own.
  void set_node(const EmulatedDevice& device, const std::string& file);
  /// The real location of a path such as "/dev/ttyACM0".
  std::string real_path(const std::string& path) const;

 private:
  _UMockdevTestbed* testbed_;
  std::vector<_UMockdevIoctlBase*> handlers_;
};

}  // namespace lamplock::usb::test
