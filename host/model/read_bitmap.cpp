#include "host/model/read_bitmap.hpp"

#include <fmt/format.h>
#include <stb/stb_image.h>

#include <cstddef>
#include <cstdlib>
#include <limits>
#include <memory>
#include <string>

#include "host/bytes.hpp"
#include "host/file.hpp"

namespace lamplock::model {
namespace {

// Far more than a glass block can show, and few enough for the memory (4 bytes a pixel).
constexpr long long max_pixels = 100'000'000;

std::uint32_t u32_at(const std::string& bytes, std::size_t offset,
                     std::endian order = std::endian::little) {
  return load<std::uint32_t>(bytes.data() + offset, order);
}

/// The image library silently completes a truncated BMP, so its size is checked first: file header
/// of 14 bytes with the offset of the pixels at 10, then the bits a pixel at 28 (24); rows are
/// padded to 4.
void require_whole_bmp(const std::filesystem::path& file, const std::string& bytes, int width,
                       int height) {
  constexpr std::size_t shortest = 30, header_size_offset = 14;
  constexpr std::uint32_t core_header = 12;  // that of OS/2, with narrower fields
  if (!bytes.starts_with("BM")) return;
  if (bytes.size() < shortest) refuse(file, "the image is cut off", "export it again");
  const bool core = u32_at(bytes, header_size_offset) == core_header;
  const std::uint64_t bits = load<std::uint8_t>(bytes.data() + (core ? 24 : 28));
  const std::uint64_t row = (static_cast<std::uint64_t>(width) * bits + 31) / 32 * 4;
  const std::uint64_t need = u32_at(bytes, 10) + row * static_cast<std::uint64_t>(height);
  if (bytes.size() < need) refuse(file, "the image is cut off", "export it again");
}

/// The library does not detect a missing end of a PNG either (of a JPEG it does): 8 bytes, then
/// chunks of length (big-endian), type, data and checksum up to the chunk IEND.
void require_whole_png(const std::filesystem::path& file, const std::string& bytes) {
  constexpr std::size_t signature = 8, around_data = 12;
  if (bytes.compare(1, 3, "PNG") != 0) return;
  for (std::size_t at = signature; at + around_data <= bytes.size();) {
    const std::size_t length = u32_at(bytes, at, std::endian::big);
    if (bytes.compare(at + 4, 4, "IEND") == 0) return;
    at += around_data + length;
  }
  refuse(file, "the image is cut off", "export it again");
}

std::uint8_t grey_over_white(const stbi_uc* pixel) {
  // Luma of Rec. ITU-R BT.601 in 1/1000; the sum of products fits easily.
  const int luma = (299 * pixel[0] + 587 * pixel[1] + 114 * pixel[2] + 500) / 1000;
  return static_cast<std::uint8_t>((luma * pixel[3] + 255 * (255 - pixel[3]) + 127) / 255);
}

}  // namespace

Bitmap read_bitmap(const std::filesystem::path& path) {
  return decode_bitmap(path, read_file(path));
}

Bitmap decode_bitmap(const std::filesystem::path& path, const std::string& bytes) {
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    refuse(path, "the image is too large", "give an image of at most 100 million pixels");
  }
  if (!bytes.starts_with("\x89PNG") && !bytes.starts_with("BM") && !bytes.starts_with("\xFF\xD8"))
    refuse(path, "is not a PNG, BMP or JPEG", "give a PNG, BMP or JPEG");
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int length = static_cast<int>(bytes.size());
  Bitmap bitmap;
  int channels = 0;
  if (stbi_info_from_memory(data, length, &bitmap.width, &bitmap.height, &channels) == 0) {
    refuse(path, fmt::format("the image is damaged ({})", stbi_failure_reason()),
           "export it again");
  }
  // A negative height marks a BMP whose rows begin at the top.
  const long long height = std::abs(static_cast<long long>(bitmap.height));
  if (bitmap.width <= 0 || height == 0 || bitmap.width * height > max_pixels) {
    refuse(path, fmt::format("has {} x {} pixels", bitmap.width, height),
           "give an image of at most 100 million pixels");
  }
  bitmap.height = static_cast<int>(height);
  require_whole_png(path, bytes);
  require_whole_bmp(path, bytes, bitmap.width, bitmap.height);
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(data, length, &bitmap.width, &bitmap.height, &channels, STBI_rgb_alpha),
      stbi_image_free);
  if (!pixels) {
    refuse(path, fmt::format("the image is damaged ({})", stbi_failure_reason()),
           "export it again");
  }
  const std::size_t count =
      static_cast<std::size_t>(bitmap.width) * static_cast<std::size_t>(bitmap.height);
  bitmap.grey.resize(count);
  for (std::size_t i = 0; i < count; ++i) bitmap.grey[i] = grey_over_white(pixels.get() + 4 * i);
  return bitmap;
}

}  // namespace lamplock::model
