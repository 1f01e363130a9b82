// An image for the flash of an RP2040: whole sectors, checked before a board is stopped.
//
// In:  bytes for addresses, from an image file. Out: sectors by address, or an Error.
// Who: readers of image files, Flasher.
//
// The checks are those that the chip itself would make too late: whether it would start the image
// (RP2040 datasheet, 2.8.1.3.1), whether an image of lamplock would start itself (its CRC,
// boot/loader.cpp), and whether the image would overwrite the settings at higher addresses
// (shared/boards/pico_flash.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lamplock::flash {

inline constexpr std::uint32_t flash_base = 0x1000'0000;  ///< RP2040 datasheet, 2.2
/// Units of erase and program commands (W25Q16JV data sheet, chapter 8).
inline constexpr std::size_t sector_size = 4096;
inline constexpr std::size_t page_size = 256;
inline constexpr std::uint8_t erased = 0xff;

/// Bytes for consecutive addresses.
struct Part {
  std::uint32_t address = 0;
  std::vector<std::uint8_t> bytes{};
};

/// A complete sector; bytes that are not in the image are erased.
struct Sector {
  std::uint32_t address = 0;
  std::array<std::uint8_t, sector_size> bytes{};
};

/// Sectors by address; the first one has the second-stage boot code.
struct FlashImage {
  std::vector<Sector> sectors{};
  std::size_t size = 0;  ///< bytes in the image file
};

/// Parts in any order. Throws Error(bad_input), about `where`: parts that overlap or lie outside of
/// the area for images, missing boot code at the begin of the flash, a wrong checksum of the boot
/// code or of an image of lamplock. In other images only the boot code can be checked.
FlashImage make_flash_image(std::vector<Part> parts, const std::string& where);

}  // namespace lamplock::flash
