#include "host/model/bmp.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "host/bytes.hpp"
#include "host/file.hpp"
#include "host/model/picture.hpp"
#include "host/number_text.hpp"

namespace lamplock::model {
namespace {

using std::filesystem::path;

constexpr std::size_t rgba = 4;
constexpr std::size_t pixels_field = 10;   ///< of the file header: where the pixels begin
constexpr std::size_t file_header = 14;    ///< bytes before the header of the picture
constexpr std::uint32_t core_header = 12;  ///< of OS/2 1, with narrower fields
constexpr std::uint32_t info_header = 40;  ///< of Windows 3; the others begin like it
constexpr std::uint32_t os2_header = 64;   ///< of OS/2 2; its compressions have other numbers
/// BITMAPV2INFOHEADER and later contain the masks of the colours, BITMAPV3INFOHEADER that of alpha.
constexpr std::uint32_t masks_header = 52, alpha_header = 56;
/// Sizes of headers: Windows 3, V2, V3, V4 and V5 ("Bitmap Header Types", Microsoft), OS/2.
constexpr std::array<std::uint32_t, 7> header_sizes{
    core_header, info_header, masks_header, alpha_header, os2_header, 108, 124};

/// Values of `compression`.
constexpr std::uint32_t uncompressed = 0, bit_fields = 3, bit_fields_with_alpha = 6;

/// Where a colour is in the bits of a pixel, red, green, blue and alpha; 0: it has none.
using Masks = std::array<std::uint32_t, rgba>;
constexpr Masks masks_of_16{0x7c00, 0x3e0, 0x1f, 0};
constexpr Masks masks_of_32{0xff0000, 0xff00, 0xff, 0xff000000};

/// The header, checked.
struct BmpHeader {
  std::size_t width = 0, height = 0;
  bool from_top = false;
  unsigned bits = 0;            ///< of a pixel
  std::size_t pixels = 0;       ///< where they begin
  std::size_t palette = 0;      ///< where it begins
  std::size_t colours = 0;      ///< of the palette
  std::size_t entry_bytes = 0;  ///< of a colour of the palette
  Masks masks{};                ///< for 16 and 32 bits

  std::size_t row_bytes() const { return (width * bits + 31) / 32 * 4; }
  bool has_palette() const { return bits <= 8; }
};

/// Compressed pictures are refused by what they are, not as damaged ones.
void require_uncompressed(const path& file, std::uint32_t compression, std::uint32_t header,
                          unsigned bits) {
  const bool with_masks =
      header != os2_header && (compression == bit_fields || compression == bit_fields_with_alpha);
  if (compression == uncompressed) return;
  if (!with_masks) refuse(file, "compressed BMP is not read", "save it uncompressed or as PNG");
  if (bits != 16 && bits != 32)
    refuse_damaged(file, fmt::format("masks of colours for {} bits a pixel", bits).c_str());
}

/// The masks of a picture with 16 or 32 bits a pixel. Those of Windows 3 follow its header.
Masks masks_of(const path& file, const std::string& bytes, std::uint32_t header,
               std::uint32_t compression, unsigned bits) {
  if (compression == uncompressed) return bits == 16 ? masks_of_16 : masks_of_32;
  const bool has_alpha = compression == bit_fields_with_alpha || header >= alpha_header;
  const std::size_t count = has_alpha ? 4 : 3, at = file_header + info_header;
  if (bytes.size() < at + count * 4) refuse_cut_off(file);
  Masks masks{};
  for (std::size_t i = 0; i < count; ++i) masks[i] = load<std::uint32_t>(bytes.data() + at + i * 4);
  for (const std::uint32_t mask : masks) {
    const std::uint32_t shifted = mask == 0 ? 0 : mask >> std::countr_zero(mask);
    if ((shifted & (shifted + 1)) != 0 || (bits == 16 && mask > 0xffff))
      refuse_damaged(file, "masks of colours with gaps");
  }
  if ((masks[0] | masks[1] | masks[2]) == 0) refuse_damaged(file, "empty masks of colours");
  return masks;
}

/// Where the palette is and how many colours it has: it fills the bytes up to the pixels.
void find_palette(BmpHeader& bmp, std::uint32_t header) {
  bmp.palette = file_header + header;
  bmp.entry_bytes = header == core_header ? 3 : 4;
  bmp.colours = std::min((bmp.pixels - bmp.palette) / bmp.entry_bytes, std::size_t{1} << bmp.bits);
}

BmpHeader checked_header(const path& file, const std::string& bytes) {
  if (bytes.size() < file_header + core_header) refuse_cut_off(file);
  const char* data = bytes.data();
  const auto header = load<std::uint32_t>(data + file_header);
  if (std::ranges::find(header_sizes, header) == header_sizes.end())
    refuse(file, fmt::format("BMP with a header of {} bytes is not read", header),
           "save it as BMP of Windows or as PNG");
  if (bytes.size() < file_header + header) refuse_cut_off(file);
  const bool core = header == core_header;
  BmpHeader bmp;
  const long long width = core ? load<std::uint16_t>(data + 18) : load<std::int32_t>(data + 18);
  const long long height = core ? load<std::uint16_t>(data + 20) : load<std::int32_t>(data + 22);
  bmp.from_top = height < 0;
  require_size(file, width, std::abs(height));
  bmp.width = static_cast<std::size_t>(width);
  bmp.height = static_cast<std::size_t>(std::abs(height));
  bmp.bits = load<std::uint16_t>(data + (core ? 24 : 28));
  const std::uint32_t compression = core ? uncompressed : load<std::uint32_t>(data + 30);
  require_uncompressed(file, compression, header, bmp.bits);
  constexpr std::array<unsigned, 7> depths{1, 2, 4, 8, 16, 24, 32};
  if (std::ranges::find(depths, bmp.bits) == depths.end())
    refuse_damaged(file, fmt::format("{} bits a pixel", bmp.bits).c_str());
  if (load<std::uint16_t>(data + (core ? 22 : 26)) != 1) refuse_damaged(file, "not one plane");
  bmp.pixels = load<std::uint32_t>(data + pixels_field);
  if (bmp.pixels < file_header + header) refuse_damaged(file, "its pixels begin in its header");
  if (bmp.has_palette()) find_palette(bmp, header);
  if (bmp.bits == 16 || bmp.bits == 32)
    bmp.masks = masks_of(file, bytes, header, compression, bmp.bits);
  if (bytes.size() < bmp.pixels + bmp.row_bytes() * bmp.height) refuse_cut_off(file);
  return bmp;
}

/// The part of a pixel under a mask, 0..255.
std::uint8_t under_mask(std::uint32_t pixel, std::uint32_t mask) {
  if (mask == 0) return 0;
  const int shift = std::countr_zero(mask);
  const std::uint64_t max = mask >> shift, part = (pixel & mask) >> shift;
  return static_cast<std::uint8_t>((part * white + max / 2) / max);
}

/// Writes the colours of a row with a palette to `to`, RGBA.
void read_palette_row(const path& file, const BmpHeader& bmp, const char* data, const char* row,
                      std::uint8_t* to) {
  for (std::size_t x = 0; x < bmp.width; ++x) {
    const auto byte = load<std::uint8_t>(row + x * bmp.bits / 8);
    const std::size_t shift = 8 - bmp.bits - x * bmp.bits % 8;
    const std::size_t number = (byte >> shift) & ((1U << bmp.bits) - 1);
    if (number >= bmp.colours)
      refuse_damaged(file, fmt::format("a pixel has colour {} of a palette of {}", number + 1,
                                       count_text(bmp.colours, "colour"))
                               .c_str());
    const char* entry = data + bmp.palette + number * bmp.entry_bytes;  // blue, green, red
    for (std::size_t i = 0; i < 3; ++i) *to++ = load<std::uint8_t>(entry + 2 - i);
    *to++ = opaque;
  }
}

/// Writes the colours of a row of 16, 24 or 32 bits a pixel to `to`, RGBA.
void read_direct_row(const BmpHeader& bmp, const char* row, std::uint8_t* to) {
  for (std::size_t x = 0; x < bmp.width; ++x, to += rgba) {
    if (bmp.bits == 24) {
      for (std::size_t i = 0; i < 3; ++i) to[i] = load<std::uint8_t>(row + x * 3 + 2 - i);
      to[3] = opaque;
      continue;
    }
    const std::uint32_t pixel =
        bmp.bits == 16 ? load<std::uint16_t>(row + x * 2) : load<std::uint32_t>(row + x * 4);
    for (std::size_t i = 0; i < rgba; ++i) to[i] = under_mask(pixel, bmp.masks[i]);
    if (bmp.masks[3] == 0) to[3] = opaque;
  }
}

/// Many programs leave the byte of alpha 0: a picture of which nothing is visible is opaque.
void make_visible(std::vector<std::uint8_t>& colours) {
  for (std::size_t i = 3; i < colours.size(); i += rgba)
    if (colours[i] != 0) return;
  for (std::size_t i = 3; i < colours.size(); i += rgba) colours[i] = opaque;
}

}  // namespace

bool is_bmp(const std::string& bytes) { return bytes.starts_with("BM"); }

Bitmap decode_bmp(const path& file, const std::string& bytes) {
  const BmpHeader bmp = checked_header(file, bytes);
  std::vector<std::uint8_t> colours(bmp.width * bmp.height * rgba);
  for (std::size_t y = 0; y < bmp.height; ++y) {
    const std::size_t from = bmp.from_top ? y : bmp.height - 1 - y;
    const char* row = bytes.data() + bmp.pixels + from * bmp.row_bytes();
    std::uint8_t* to = colours.data() + y * bmp.width * rgba;
    if (bmp.has_palette())
      read_palette_row(file, bmp, bytes.data(), row, to);
    else
      read_direct_row(bmp, row, to);
  }
  make_visible(colours);
  return bitmap_of_colours(colours, static_cast<int>(bmp.width), static_cast<int>(bmp.height),
                           rgba);
}

}  // namespace lamplock::model
