#include "host/flash/image_board.hpp"

#include <optional>

#include "shared/wire/binary_info.hpp"

namespace lamplock::flash {
namespace {

namespace info = wire::binary_info;

constexpr std::uint32_t boot_code_size = 256;  // RP2040 datasheet, 2.8.1.3.1
/// More entries, or longer texts, are no binary info of lamplock.
constexpr std::uint32_t max_entries = 256, max_text = 64;

/// Bytes of an image by address; an address outside of it has none.
class ImageReader {
 public:
  explicit ImageReader(const FlashImage& image) : image_(image) {}

  std::optional<std::uint8_t> byte(std::uint32_t address) const {
    for (const Sector& sector : image_.sectors)
      if (address >= sector.address && address - sector.address < sector_size)
        return sector.bytes[address - sector.address];
    return std::nullopt;
  }
  std::optional<std::uint32_t> word(std::uint32_t address) const {
    std::uint32_t value = 0;
    for (std::uint32_t i = 0; i < 4; ++i) {
      const auto next = byte(address + i);
      if (!next) return std::nullopt;
      value |= std::uint32_t{*next} << (8 * i);
    }
    return value;
  }
  std::string text(std::uint32_t address) const {
    std::string text;
    for (std::uint32_t i = 0; i < max_text; ++i) {
      const auto next = byte(address + i);
      if (!next) return "";
      if (*next == 0) return text;
      text += static_cast<char>(*next);
    }
    return "";
  }

 private:
  const FlashImage& image_;
};

/// Text of the entry with this identifier in the list of a header.
std::string entry_text(const ImageReader& image, std::uint32_t header, std::uint32_t id) {
  const auto begin = image.word(header + 4), end = image.word(header + 8);
  if (!begin || !end || *end < *begin || *end - *begin > 4 * max_entries) return "";
  for (std::uint32_t at = *begin; at < *end; at += 4) {
    const auto entry = image.word(at);
    if (!entry) return "";
    const auto type = image.word(*entry), found = image.word(*entry + 4),
               text = image.word(*entry + 8);
    constexpr std::uint32_t text_type = info::id_and_text | std::uint32_t{info::tag_raspberry_pi}
                                                                << 16;
    if (type == text_type && found == id && text) return image.text(*text);
  }
  return "";
}

}  // namespace

std::string board_of_image(const FlashImage& image) {
  const ImageReader reader(image);
  for (std::uint32_t offset = 0; offset < info::max_header_offset; offset += 4) {
    const std::uint32_t header = flash_base + boot_code_size + offset;
    if (reader.word(header) != info::begin_mark || reader.word(header + 16) != info::end_mark)
      continue;
    if (entry_text(reader, header, info::program_name) != "lamplock") return "";
    return entry_text(reader, header, info::board_name);
  }
  return "";
}

}  // namespace lamplock::flash
