// Reads the BOS descriptor of a device and the Microsoft OS 2.0 descriptor set that it announces,
// as strictly as Windows does, which on an error installs no driver and reports nothing.
//
// In:  bytes. Out: how to request the set, and its contents; every departure as a line of text.
// Who: UsbHost. Standards: USB 3.2, 9.6.2; "Microsoft OS 2.0 Descriptors Specification", 2018.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/chip/usb_host/descriptors.hpp"

namespace lamplock::sim::chip::usb {

/// wIndex of the vendor request for the set (specification, table 8).
inline constexpr std::uint16_t microsoft_set_index = 7;

/// How to request the set.
struct MicrosoftCapability {
  std::uint8_t request = 0;
  std::uint16_t set_size = 0;
};

/// Values that Windows uses from the set.
struct MicrosoftSet {
  std::uint8_t interface = 0;      ///< first one of the function concerned
  std::string compatible_id;       ///< "WINUSB": Windows brings the driver along
  std::vector<std::string> guids;  ///< under which programs find the interface
};

/// Length of the whole, from its first 5 bytes; 0 if they are wrong.
std::uint16_t parse_bos_head(std::span<const std::uint8_t> bytes, Violations& violations);
/// Empty if the device has nothing for Windows.
std::optional<MicrosoftCapability> parse_bos(std::span<const std::uint8_t> bytes,
                                             Violations& violations);
MicrosoftSet parse_microsoft_set(std::span<const std::uint8_t> bytes,
                                 const MicrosoftCapability& capability, Violations& violations);

}  // namespace lamplock::sim::chip::usb
