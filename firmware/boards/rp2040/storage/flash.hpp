// The flash chip: the areas of the stores, and the unique number.
//
// Who: main loop, at rest. An erase takes 45 to 400 ms, a page 0.4 to 3 ms (W25Q16JV data sheet),
// and flash cannot be read meanwhile. Interrupts continue: they run from SRAM.
//
// The ROM's functions in the order of the datasheet, 2.8.3.1.3; they leave flash readable only by
// commands, so start_xip() follows.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/settings/record_log.hpp"
#include "shared/boards/pico_flash.hpp"

namespace lamplock::rp2040 {

/// The area of a store: SettingsFlash.
class FlashArea {
 public:
  /// All areas have this size, so that one instantiation serves all.
  static constexpr std::uint32_t sectors = boards::settings_sectors;
  static_assert(sectors == boards::program_sectors);

  /// Begins `offset` bytes after the start of the flash, at a sector.
  explicit FlashArea(std::uint32_t offset) : offset_(offset) {}
  void read(std::uint32_t at, std::span<std::uint8_t> out) const;
  void erase(std::uint32_t at);
  void program(std::uint32_t at, std::span<const std::uint8_t, settings::flash_page> page);

 private:
  std::uint32_t offset_;
};

/// Unique number of the flash chip (command 4Bh), as 16 characters.
std::array<char, 16> flash_unique_number();

}  // namespace lamplock::rp2040
