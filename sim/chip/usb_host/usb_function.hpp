// The interface that carries bytes between the PC and a device. Who: UsbHost and its users.
#pragma once

#include <cstdint>

namespace lamplock::sim::chip {

/// The serial port's driver, or a vendor interface that a program has claimed.
enum class UsbFunction : std::uint8_t { serial, vendor };

}  // namespace lamplock::sim::chip
