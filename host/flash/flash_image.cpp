#include "host/flash/flash_image.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "host/error.hpp"
#include "shared/boards/boot2_crc32.hpp"
#include "shared/boards/pico_flash.hpp"
#include "shared/wire/crc32.hpp"

namespace lamplock::flash {
namespace {

/// Begin of the settings.
constexpr std::uint32_t limit = flash_base + boards::settings_offset;
static_assert(limit % sector_size == 0);

[[noreturn]] void refuse(const std::string& where, const std::string& what,
                         const std::string& remedy) {
  throw Error(Exit::bad_input, where, what, remedy);
}

void check_place(const Part& part, const std::string& where) {
  if (part.address < flash_base || part.address >= limit ||
      part.bytes.size() > limit - part.address)
    refuse(where,
           fmt::format("{} bytes at address 0x{:08x} are not inside 0x{:08x} to 0x{:08x}, the "
                       "flash for firmware, which ends before the settings",
                       part.bytes.size(), part.address, flash_base, limit - 1),
           "build the image of lamplock again");
}

void check_overlap(const Part& before, const Part& after, const std::string& where) {
  if (after.address - before.address < before.bytes.size())
    refuse(where, fmt::format("two parts overlap at 0x{:08x}", after.address),
           "build the image again");
}

std::uint32_t word_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t i = 4; i-- > 0;) word = word << 8 | bytes[at + i];
  return word;
}

/// The ROM starts boot code of 252 bytes if its CRC follows it.
void check_boot_code(const FlashImage& image, const std::string& where) {
  constexpr std::size_t code_size = 252;
  const char* const remedy = "give an image that starts by itself, such as lamplock-rp2040.uf2";
  if (image.sectors.empty() || image.sectors.front().address != flash_base)
    refuse(where, "has no code at the begin of the flash, where the chip starts", remedy);
  const std::span<const std::uint8_t> bytes = image.sectors.front().bytes;
  if (boards::boot2_crc32(bytes.first(code_size)) != word_at(bytes, code_size))
    refuse(where, "has boot code with a wrong checksum: the chip would not start it", remedy);
}

/// Contents of the flash from its begin; bytes that are not in the image are erased.
std::vector<std::uint8_t> contents(const FlashImage& image) {
  const std::size_t last = image.sectors.back().address - flash_base;
  std::vector<std::uint8_t> bytes(last + sector_size, erased);
  for (const Sector& sector : image.sectors)
    std::copy(sector.bytes.begin(), sector.bytes.end(),
              bytes.begin() + static_cast<std::ptrdiff_t>(sector.address - flash_base));
  return bytes;
}

/// The CRC is the last word that is not erased; or, once in 2^32 images, the erased word after it.
bool ends_with_its_crc(std::span<const std::uint8_t> bytes) {
  constexpr std::uint32_t erased_word = 0xffff'ffff;
  std::size_t end = bytes.size();
  while (end > page_size + 4 && word_at(bytes, end - 4) == erased_word) end -= 4;
  const auto is_crc = [&](std::size_t at) {
    return at + 4 <= bytes.size() &&
           wire::crc32(bytes.subspan(page_size, at - page_size)) == word_at(bytes, at);
  };
  return is_crc(end - 4) || is_crc(end);
}

/// The loader in an image of lamplock starts it only with a correct CRC; the previous image would
/// be lost by then.
void check_own_crc(const FlashImage& image, const std::string& where) {
  const std::vector<std::uint8_t> bytes = contents(image);
  if (std::equal(boards::image_mark.begin(), boards::image_mark.end(),
                 bytes.begin() + boards::image_mark_offset) &&
      !ends_with_its_crc(bytes))
    refuse(where, "is an image of lamplock with a wrong checksum: the board would not start it",
           "copy or build the file again");
}

void put(const Part& part, FlashImage& image) {
  for (std::size_t i = 0; i < part.bytes.size(); ++i) {
    const std::uint32_t address = part.address + static_cast<std::uint32_t>(i);
    const auto within = static_cast<std::uint32_t>(address % sector_size);
    if (image.sectors.empty() || image.sectors.back().address != address - within) {
      image.sectors.push_back({address - within, {}});
      image.sectors.back().bytes.fill(erased);
    }
    image.sectors.back().bytes[within] = part.bytes[i];
  }
  image.size += part.bytes.size();
}

}  // namespace

FlashImage make_flash_image(std::vector<Part> parts, const std::string& where) {
  std::stable_sort(parts.begin(), parts.end(),
                   [](const Part& a, const Part& b) { return a.address < b.address; });
  FlashImage image;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    check_place(parts[i], where);
    if (i > 0) check_overlap(parts[i - 1], parts[i], where);
    put(parts[i], image);
  }
  check_boot_code(image, where);
  check_own_crc(image, where);
  return image;
}

}  // namespace lamplock::flash
