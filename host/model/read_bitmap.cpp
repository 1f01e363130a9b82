#include "host/model/read_bitmap.hpp"

#include <fmt/format.h>
#include <stb/stb_image.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "host/bytes.hpp"
#include "host/file.hpp"
#include "host/model/jpeg.hpp"
#include "host/model/picture.hpp"
#include "host/model/png.hpp"
#include "host/number_text.hpp"

namespace lamplock::model {
namespace {

using std::filesystem::path;

/// The first bytes of a format that is not read, at an offset.
struct ForeignPicture {
  std::string_view name;
  std::size_t offset;
  std::string_view bytes;
};

constexpr ForeignPicture foreign_pictures[] = {
    {"GIF", 0, "GIF8"},        {"TIFF", 0, {"II*\0", 4}}, {"TIFF", 0, {"MM\0*", 4}},
    {"TIFF", 0, {"II+\0", 4}},  // with offsets of 64 bits
    {"TIFF", 0, {"MM\0+", 4}}, {"WebP", 8, "WEBP"},       {"HEIC", 4, "ftyphei"},
    {"HEIC", 4, "ftypmif1"},   {"AVIF", 4, "ftypavi"},    {"JPEG 2000", 4, "jP  "},
    {"JPEG XL", 4, "JXL "},    {"Photoshop", 0, "8BPS"},
};

constexpr std::string_view foreign_extensions[] = {".gif",  ".tif",  ".tiff", ".webp", ".heic",
                                                   ".heif", ".avif", ".jp2",  ".jxl",  ".psd"};

[[noreturn]] void refuse_foreign(const path& file, std::string_view bytes) {
  for (const ForeignPicture& one : foreign_pictures)
    if (bytes.size() > one.offset && bytes.substr(one.offset).starts_with(one.bytes))
      refuse(file, fmt::format("is a {} picture, which is not read", one.name),
             "convert it to PNG with any editor of pictures");
  refuse(file, "is not a PNG, BMP or JPEG", "give a PNG, BMP or JPEG");
}

/// The image library silently completes a truncated BMP, so its size is checked first: file header
/// of 14 bytes with the offset of the pixels at 10, then the bits a pixel at 28 (24); rows are
/// padded to 4.
void require_whole_bmp(const path& file, const std::string& bytes, int width, int height) {
  constexpr std::size_t shortest = 30, header_size_offset = 14;
  constexpr std::uint32_t core_header = 12;  // that of OS/2, with narrower fields
  if (bytes.size() < shortest) refuse_cut_off(file);
  const bool core = load<std::uint32_t>(bytes.data() + header_size_offset) == core_header;
  const std::uint64_t bits = load<std::uint8_t>(bytes.data() + (core ? 24 : 28));
  const std::uint64_t row = (static_cast<std::uint64_t>(width) * bits + 31) / 32 * 4;
  const std::uint64_t need =
      load<std::uint32_t>(bytes.data() + 10) + row * static_cast<std::uint64_t>(height);
  if (bits == 0) refuse_damaged(file, "no bits a pixel");
  if (bytes.size() < need) refuse_cut_off(file);
}

/// Refuses pixels whose colour the palette does not have: the image library paints them black. The
/// palette is between the headers and the pixels, 4 bytes each colour (3 with the core header).
/// `bytes` are whole.
void require_colours_of_bmp(const path& file, const std::string& bytes, int width, int height) {
  constexpr std::size_t file_header = 14;
  constexpr std::uint32_t core_header = 12;
  const auto header = load<std::uint32_t>(bytes.data() + file_header);
  const bool core = header == core_header;
  const unsigned bits = load<std::uint8_t>(bytes.data() + (core ? 24 : 28));
  if (bits > 8 || 8 % bits != 0) return;  // no palette, or not read
  const std::size_t pixels = load<std::uint32_t>(bytes.data() + 10);
  const std::size_t before = file_header + header;
  const std::size_t colours = pixels > before ? (pixels - before) / (core ? 3 : 4) : 0;
  const std::size_t row_bytes = (static_cast<std::size_t>(width) * bits + 31) / 32 * 4;
  for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) {
    for (std::size_t x = 0; x < static_cast<std::size_t>(width); ++x) {
      const auto byte = load<std::uint8_t>(bytes.data() + pixels + y * row_bytes + x * bits / 8);
      const std::size_t shift = 8 - bits - x * bits % 8;
      const std::size_t colour = (byte >> shift) & ((1U << bits) - 1);
      if (colour >= colours)
        refuse_damaged(file, fmt::format("a pixel has colour {} of a palette of {}", colour + 1,
                                         count_text(colours, "colour"))
                                 .c_str());
    }
  }
}

Bitmap decode_bmp(const path& file, const std::string& bytes) {
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    refuse(file, "the image is too large", "give an image of at most 100 million pixels");
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int length = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (stbi_info_from_memory(data, length, &width, &height, &channels) == 0)
    refuse_damaged(file, stbi_failure_reason());
  // A negative height marks a BMP whose rows begin at the top.
  const long long rows = std::abs(static_cast<long long>(height));
  require_size(file, width, rows);
  require_whole_bmp(file, bytes, width, static_cast<int>(rows));
  require_colours_of_bmp(file, bytes, width, static_cast<int>(rows));
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(data, length, &width, &height, &channels, STBI_rgb_alpha),
      stbi_image_free);
  if (!pixels) refuse_damaged(file, stbi_failure_reason());
  constexpr int rgba = 4;
  const std::span<const std::uint8_t> colours(
      pixels.get(), static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * rgba);
  return bitmap_of_colours(colours, width, height, rgba);
}

}  // namespace

Bitmap read_bitmap(const path& path) { return decode_bitmap(path, read_file(path)); }

Bitmap decode_bitmap(const path& path, const std::string& bytes) {
  if (is_png(bytes)) return decode_png(path, bytes);
  if (is_jpeg(bytes)) return decode_jpeg(path, bytes);
  if (bytes.starts_with("BM")) return decode_bmp(path, bytes);
  refuse_foreign(path, bytes);
}

bool is_foreign_picture(const std::string& extension) {
  return std::ranges::find(foreign_extensions, extension) != std::end(foreign_extensions);
}

}  // namespace lamplock::model
