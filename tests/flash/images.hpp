// Images with valid boot code for an RP2040, generated in tests.
#pragma once

#include <algorithm>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "host/flash/flash_image.hpp"
#include "shared/boards/boot2_crc32.hpp"
#include "shared/boards/pico_flash.hpp"
#include "shared/wire/crc32.hpp"

namespace lamplock::flash::test {

/// Writes the checksum after the boot code at the beginning of these bytes.
inline void stamp(std::span<std::uint8_t> flash) {
  const std::uint32_t crc = boards::boot2_crc32(flash.first(252));
  for (std::size_t i = 0; i < 4; ++i) flash[252 + i] = static_cast<std::uint8_t>(crc >> 8 * i);
}

/// True if the ROM would start the contents of a flash.
inline bool starts(std::span<const std::uint8_t> flash) {
  std::vector<std::uint8_t> code(flash.begin(), flash.begin() + 256);
  stamp(code);
  return std::equal(code.begin(), code.end(), flash.begin());
}

/// An image of `size` random bytes at the beginning of the flash, with valid boot code.
inline FlashImage noise_image(std::size_t size, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Part part{flash_base, std::vector<std::uint8_t>(std::max<std::size_t>(size, page_size))};
  for (std::uint8_t& byte : part.bytes) byte = static_cast<std::uint8_t>(random());
  stamp(part.bytes);
  return make_flash_image({std::move(part)}, "test");
}

/// The bytes of an image with lamplock's mark and CRC; `size` is a multiple of a word.
inline std::vector<std::uint8_t> lamplock_bytes(std::size_t size, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<std::uint8_t> bytes(size);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
  std::copy(boards::image_mark.begin(), boards::image_mark.end(),
            bytes.begin() + boards::image_mark_offset);
  stamp(bytes);
  const std::uint32_t crc = wire::crc32(std::span(bytes).subspan(256, size - 260));
  for (std::size_t i = 0; i < 4; ++i) bytes[size - 4 + i] = static_cast<std::uint8_t>(crc >> 8 * i);
  return bytes;
}

/// True if the flash contains the image in every sector.
inline bool holds(std::span<const std::uint8_t> flash, const FlashImage& image) {
  return std::all_of(image.sectors.begin(), image.sectors.end(), [&](const Sector& sector) {
    return std::equal(sector.bytes.begin(), sector.bytes.end(),
                      flash.begin() + (sector.address - flash_base));
  });
}

}  // namespace lamplock::flash::test
