// Which USB devices lamplock knows, by their numbers and texts.
//
// In:  descriptors. Out: what kind of device it is and its usual name.
// Who: flashing, lists of devices.
#pragma once

#include <string_view>

#include "host/usb/usb.hpp"

namespace lamplock::usb {

enum class Kind : std::uint8_t {
  other,
  board,        ///< runs lamplock
  boot_loader,  ///< an RP2040 without a program, or with BOOTSEL held at its start
  pendant
};

struct KnownDevice {
  Kind kind = Kind::other;
  std::string_view name{};
};

/// The text by which a board of ours is known.
inline constexpr std::string_view board_manufacturer = "lamplock";

/// A board is one by its manufacturer's text too: its numbers are free for anybody's tests.
KnownDevice known_device(const DeviceInfo& device);

}  // namespace lamplock::usb
