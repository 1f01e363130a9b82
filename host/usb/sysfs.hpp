// Reads properties of USB devices from /sys, which needs no permission: texts, serial ports, HID
// nodes.
// In:  the place of a device, "1-4.2". Out: text of an attribute, paths in /dev.
// Who: libusb_bus, lists of devices, the search for the serial port of a board.
// Layout: Documentation/ABI/testing/sysfs-bus-usb of the kernel.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lamplock::usb {

/// The kernel's folder of USB devices by place.
inline constexpr const char* sysfs_devices = "/sys/bus/usb/devices";

/// Its folder of serial ports by name.
inline constexpr const char* sysfs_ports = "/sys/class/tty";

/// The device node of a name, which may be a link ("/dev/serial/by-id/...").
std::filesystem::path device_node(const std::filesystem::path& name);

/// The manufacturer's text of the device with this serial port, "/dev/ttyACM0" or a link to it;
/// empty if it is not on USB.
std::string manufacturer_of_port(const std::string& port,
                                 const std::filesystem::path& root = sysfs_ports);

/// Attributes of devices; `root` is another folder in tests.
class Sysfs {
 public:
  explicit Sysfs(std::filesystem::path root = sysfs_devices) : root_(std::move(root)) {}

  /// Such as "serial"; empty if there is none.
  std::string text(const std::string& place, const std::string& attribute) const;
  /// "/dev/ttyACM0" and the like, by name; none until a driver has made one.
  std::vector<std::string> serial_ports(const std::string& place) const;
  /// "/dev/hidraw0" and the like, by name.
  std::vector<std::string> hid_nodes(const std::string& place) const;

 private:
  std::filesystem::path root_;
};

}  // namespace lamplock::usb
