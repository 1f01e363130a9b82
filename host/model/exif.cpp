#include "host/model/exif.hpp"

#include <bit>
#include <cstddef>
#include <cstdint>

#include "host/bytes.hpp"
#include "host/model/picture.hpp"

namespace lamplock::model {
namespace {

// "TIFF Revision 6.0", section 2: byte order, 42, offset of the first directory; a directory is the
// number of entries and entries of tag, type, count and value.
constexpr std::uint16_t orientation_tag = 274, type_short = 3, tiff_number = 42;
constexpr std::size_t exif_header_bytes = 8, exif_entry_bytes = 12, value_in_entry = 8;

/// The number at an offset; 0 outside of the block.
template <class Value>
Value number_at(std::string_view block, std::size_t offset, std::endian order) {
  if (block.size() < sizeof(Value) || offset > block.size() - sizeof(Value)) return 0;
  return load<Value>(block.data() + offset, order);
}

}  // namespace

int exif_orientation(std::string_view block) {
  if (block.size() < exif_header_bytes) return upright;
  const std::endian order = block.starts_with("MM") ? std::endian::big : std::endian::little;
  if (order == std::endian::little && !block.starts_with("II")) return upright;
  if (number_at<std::uint16_t>(block, 2, order) != tiff_number) return upright;
  std::size_t at = number_at<std::uint32_t>(block, 4, order);
  const std::size_t entries = number_at<std::uint16_t>(block, at, order);
  at += sizeof(std::uint16_t);
  for (std::size_t i = 0; i < entries && at < block.size(); ++i, at += exif_entry_bytes) {
    if (number_at<std::uint16_t>(block, at, order) != orientation_tag) continue;
    if (number_at<std::uint16_t>(block, at + 2, order) != type_short) return upright;
    const int value = number_at<std::uint16_t>(block, at + value_in_entry, order);
    return value >= upright && value <= max_orientation ? value : upright;
  }
  return upright;
}

}  // namespace lamplock::model
