// What is to be in the flash of an RP2040: whole sectors, checked before any board is touched.
//
// In:  bytes for addresses, as an image file has them. Out: sectors by address, or an Error.
// Who: readers of image files, Flasher.
//
// Judged is what the chip itself would judge, too late: whether it would start the image (RP2040
// datasheet, 2.8.1.3.1), whether an image of lamplock would start itself (its CRC,
// boot/loader.cpp), and whether the settings behind the image (shared/boards/pico_flash.hpp) would
// be overwritten.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lamplock::flash {

inline constexpr std::uint32_t flash_base = 0x1000'0000;  ///< RP2040 datasheet, 2.2
/// What one erase clears and one program command fills (W25Q16JV data sheet, chapter 8).
inline constexpr std::size_t sector_size = 4096;
inline constexpr std::size_t page_size = 256;
inline constexpr std::uint8_t erased = 0xff;

/// Bytes for consecutive addresses.
struct Part {
  std::uint32_t address = 0;
  std::vector<std::uint8_t> bytes{};
};

/// A sector with all of its bytes; those that the image does not give are erased.
struct Sector {
  std::uint32_t address = 0;
  std::array<std::uint8_t, sector_size> bytes{};
};

/// Sectors by address; the first one is that of the second-stage boot code.
struct FlashImage {
  std::vector<Sector> sectors{};
  std::size_t size = 0;  ///< bytes that were given
};

/// Parts in any order. Throws Error(bad_input), about `where`: parts that overlap, that lie outside
/// of the room for images, no boot code at the begin of the flash or one with a wrong checksum, an
/// image of lamplock with a wrong one. Of other images nothing behind the boot code can be checked.
FlashImage make_flash_image(std::vector<Part> parts, const std::string& where);

}  // namespace lamplock::flash
