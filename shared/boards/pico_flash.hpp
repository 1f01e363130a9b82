// What lies where in the flash of a Raspberry Pi Pico: for the image and for whoever prepares a
// flash for it.
#pragma once

#include <cstdint>

namespace lamplock::boards {

/// Settings: behind the room for the image (toolchain/arm/rp2040.ld), in every flash of 1 MiB or
/// more.
inline constexpr std::uint32_t settings_offset = 512 * 1024;
inline constexpr std::uint32_t settings_sectors = 4;

}  // namespace lamplock::boards
