// Selects the device on the bus to be flashed.
//
// In:  a bus, perhaps a serial number. Out: one board or boot loader, or an Error that lists them.
// Who: Update.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/usb/known_devices.hpp"
#include "host/usb/usb.hpp"

namespace lamplock::flash {

/// "lamplock board 0123 (USB 1-4.2)", for errors and lists.
std::string name_of(const usb::DeviceInfo& device);

/// Boards that run lamplock, and boot loaders.
std::vector<usb::DeviceInfo> flashable(usb::Bus& bus);

/// The only board or loader, or that with this serial number. Throws Error: no_device if there is
/// none, bad_input if there are several.
usb::DeviceInfo find_target(usb::Bus& bus, const std::string& serial);

/// The device of a kind at a place, if it is there now.
std::optional<usb::DeviceInfo> find_at(usb::Bus& bus, usb::Kind kind, const std::string& place);

}  // namespace lamplock::flash
