// What lies where in the flash of a Raspberry Pi Pico: for the image and for whoever prepares a
// flash for it.
#pragma once

#include <cstdint>

namespace lamplock::boards {

/// Settings: behind the room for the image (toolchain/arm/rp2040.ld), in every flash of 1 MiB or
/// more.
inline constexpr std::uint32_t settings_offset = 512 * 1024;
inline constexpr std::uint32_t settings_sectors = 4;

/// What a program leaves behind (machine/kept_program.hpp): behind the settings.
inline constexpr std::uint32_t program_offset = 528 * 1024;
inline constexpr std::uint32_t program_sectors = 4;
static_assert(program_offset == settings_offset + settings_sectors * 4096);

}  // namespace lamplock::boards
