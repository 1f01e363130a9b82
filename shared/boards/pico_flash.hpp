// Layout of the flash of a Raspberry Pi Pico: for the image and for programs that prepare a flash
// for it.
#pragma once

#include <array>
#include <cstdint>

namespace lamplock::boards {

/// The last bytes of the second-stage boot code, which its checksum covers, mark a lamplock image:
/// the last word of the image is the CRC-32 (shared/wire/crc32.hpp) of the bytes between the page
/// of the boot code and this word (toolchain/image).
inline constexpr std::uint32_t image_mark_offset = 244;
inline constexpr std::array<std::uint8_t, 8> image_mark = {'l', 'a', 'm', 'p', 'l', 'o', 'c', 'k'};

/// The smallest erase of the flash (W25Q16JV data sheet: sector erase).
inline constexpr std::uint32_t sector_bytes = 4096;

/// Settings: after the room for the image (toolchain/arm/rp2040.ld), in every flash of 1 MiB or
/// more.
inline constexpr std::uint32_t settings_offset = 512 * 1024;
inline constexpr std::uint32_t settings_sectors = 4;

/// Data that a program keeps (machine/console/persistent_state.hpp): after the settings.
inline constexpr std::uint32_t program_offset = 528 * 1024;
inline constexpr std::uint32_t program_sectors = 4;
static_assert(program_offset == settings_offset + settings_sectors * sector_bytes);

}  // namespace lamplock::boards
