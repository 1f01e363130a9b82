#include "host/model/read_bitmap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <string_view>

#include "host/file.hpp"
#include "host/model/bmp.hpp"
#include "host/model/jpeg.hpp"
#include "host/model/png.hpp"

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

}  // namespace

Bitmap read_bitmap(const path& path) { return decode_bitmap(path, read_file(path)); }

Bitmap decode_bitmap(const path& path, const std::string& bytes) {
  if (is_png(bytes)) return decode_png(path, bytes);
  if (is_jpeg(bytes)) return decode_jpeg(path, bytes);
  if (is_bmp(bytes)) return decode_bmp(path, bytes);
  refuse_foreign(path, bytes);
}

bool is_foreign_picture(const std::string& extension) {
  return std::ranges::find(foreign_extensions, extension) != std::end(foreign_extensions);
}

}  // namespace lamplock::model
