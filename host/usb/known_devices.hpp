// USB devices known to lamplock, by their numbers and texts.
//
// In:  descriptors. Out: the kind of the device and its usual name.
// Who: flashing, lists of devices.
#pragma once

#include <string_view>

#include "host/usb/usb.hpp"
#include "shared/boards/board_row.hpp"

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

/// The manufacturer's text of a lamplock board.
inline constexpr std::string_view board_manufacturer = "lamplock";

/// A board is identified by its manufacturer's text too, because its numbers are free for tests by
/// any maker.
KnownDevice known_device(const DeviceInfo& device);

/// The board that a device of Kind::board has the image of, by its product's text; null if that
/// names no known board, as with firmware before these texts.
const boards::BoardRow* board_of(const DeviceInfo& device);

}  // namespace lamplock::usb
