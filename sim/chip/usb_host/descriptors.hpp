// Reads a device's description of itself and finds its CDC serial port, and a vendor interface if
// there is one, as strictly as the strictest of the usual hosts.
//
// In:  the bytes of device, configuration and string descriptors.
// Out: endpoints of both; every departure from the standards as a line of text.
// Standards: USB 2.0, chapter 9; Interface Association Descriptor ECN; CDC 1.2; PSTN 1.2.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lamplock::sim::chip::usb {

using Violations = std::vector<std::string>;

/// Descriptor types (USB 2.0, table 9-5; IAD ECN; CDC 1.2, table 12).
namespace descriptor {
inline constexpr std::uint8_t device = 1;
inline constexpr std::uint8_t configuration = 2;
inline constexpr std::uint8_t string = 3;
inline constexpr std::uint8_t interface = 4;
inline constexpr std::uint8_t endpoint = 5;
inline constexpr std::uint8_t device_qualifier = 6;
inline constexpr std::uint8_t association = 11;
inline constexpr std::uint8_t bos = 15;                // USB 3.2, table 9-6
inline constexpr std::uint8_t device_capability = 16;  // USB 3.2, table 9-6
inline constexpr std::uint8_t class_interface = 0x24;
}  // namespace descriptor

/// A host's data from the device descriptor.
struct DeviceInfo {
  std::uint16_t version = 0;  ///< of USB, binary-coded decimal
  std::uint16_t vendor = 0, product = 0;
  std::uint8_t device_class = 0, device_subclass = 0, device_protocol = 0;
  std::uint8_t max_packet0 = 0;
  std::uint8_t manufacturer_string = 0, product_string = 0, serial_string = 0;
  std::uint8_t configurations = 0;
};

/// A bulk endpoint each way.
struct BulkEndpoints {
  std::uint8_t in = 0, out = 0;  ///< endpoint numbers; 0: none
  std::uint16_t in_size = 0, out_size = 0;
  bool found() const { return in != 0 && out != 0; }
};

/// A CDC serial port: its interfaces and endpoints.
struct SerialPort : BulkEndpoints {
  std::uint8_t control_interface = 0, data_interface = 0;
  std::uint8_t notify = 0;  ///< endpoint number; 0: none
  std::uint16_t notify_size = 0;
  std::uint8_t notify_interval_ms = 0;
};

/// A vendor-specific interface with two bulk endpoints.
struct VendorPipe : BulkEndpoints {
  std::uint8_t interface = 0;
  std::uint8_t string = 0;  ///< its name
};

/// A configuration and its functions.
struct Configuration {
  std::uint8_t value = 0;
  bool remote_wakeup = false;
  std::vector<std::uint8_t> strings;  ///< indices in use
  SerialPort port;
  VendorPipe vendor;
};

DeviceInfo parse_device(std::span<const std::uint8_t> bytes, Violations& violations);
/// `device` is needed for rules that concern both.
Configuration parse_configuration(std::span<const std::uint8_t> bytes, const DeviceInfo& device,
                                  Violations& violations);
/// Text of a string descriptor, other than ASCII as '?'.
std::string parse_string(std::span<const std::uint8_t> bytes, int index, Violations& violations);

}  // namespace lamplock::sim::chip::usb
