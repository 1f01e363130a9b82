// What lies where in the flash of a Raspberry Pi Pico: for the image and for whoever prepares a
// flash for it.
#pragma once

#include <array>
#include <cstdint>

namespace lamplock::boards {

/// The last bytes of the second-stage boot code, whose checksum covers them, say that the image is
/// lamplock's: its last word is the CRC-32 (shared/wire/crc32.hpp) of what lies between the boot
/// code's page and itself (toolchain/image).
inline constexpr std::uint32_t image_mark_offset = 244;
inline constexpr std::array<std::uint8_t, 8> image_mark = {'l', 'a', 'm', 'p', 'l', 'o', 'c', 'k'};

/// Settings: behind the room for the image (toolchain/arm/rp2040.ld), in every flash of 1 MiB or
/// more.
inline constexpr std::uint32_t settings_offset = 512 * 1024;
inline constexpr std::uint32_t settings_sectors = 4;

/// What a program leaves behind (machine/kept_program.hpp): behind the settings.
inline constexpr std::uint32_t program_offset = 528 * 1024;
inline constexpr std::uint32_t program_sectors = 4;
static_assert(program_offset == settings_offset + settings_sectors * 4096);

}  // namespace lamplock::boards
