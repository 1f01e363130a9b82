#include "host/model/picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <numeric>
#include <utility>
#include <vector>

#include "host/file.hpp"

namespace lamplock::model {
namespace {

/// Rec. ITU-R BT.601 in 1/1000; the sum of products fits easily.
std::uint8_t grey_of(const std::uint8_t* colour) {
  return static_cast<std::uint8_t>((299 * colour[0] + 587 * colour[1] + 114 * colour[2] + 500) /
                                   1000);
}

/// The values of an upright picture, of those in the file's order.
std::vector<std::uint8_t> upright_values(const std::vector<std::uint8_t>& values, std::size_t width,
                                         std::size_t height, int orientation) {
  const bool sides_change = orientation >= 5;
  const std::size_t columns = sides_change ? height : width;
  const std::size_t right = width - 1, bottom = height - 1;
  const auto source = [&](std::size_t x, std::size_t y) -> std::pair<std::size_t, std::size_t> {
    switch (orientation) {
      case 2:
        return {right - x, y};
      case 3:
        return {right - x, bottom - y};
      case 4:
        return {x, bottom - y};
      case 5:
        return {y, x};
      case 6:
        return {y, bottom - x};
      case 7:
        return {right - y, bottom - x};
      default:  // 8
        return {right - y, x};
    }
  };
  std::vector<std::uint8_t> turned(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto [x, y] = source(i % columns, i / columns);
    turned[i] = values[y * width + x];
  }
  return turned;
}

}  // namespace

void require_size(const std::filesystem::path& file, long long width, long long height) {
  if (width > 0 && height > 0 && width <= max_pixels / height) return;
  refuse(file, fmt::format("has {} x {} pixels", width, height),
         fmt::format("give an image of 1 to {} million pixels", max_pixels / 1'000'000));
}

void refuse_cut_off(const std::filesystem::path& file) {
  refuse(file, "the image is cut off", "export it again");
}

void refuse_damaged(const std::filesystem::path& file, const char* what) {
  refuse(file, fmt::format("the image is damaged ({})", what), "export it again");
}

Bitmap bitmap_of_colours(std::span<const std::uint8_t> colours, int width, int height,
                         int channels) {
  const auto stride = static_cast<std::size_t>(channels);
  const bool has_alpha = channels == 4;
  Bitmap bitmap{width, height, {}};
  bitmap.grey.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  bool is_opaque = true;
  for (std::size_t i = 0; i < bitmap.grey.size(); ++i) {
    const std::uint8_t* colour = colours.data() + i * stride;
    bitmap.grey[i] = grey_of(colour);
    is_opaque = is_opaque && (!has_alpha || colour[3] == opaque);
  }
  if (is_opaque) return bitmap;
  bitmap.alpha.resize(bitmap.grey.size());
  for (std::size_t i = 0; i < bitmap.alpha.size(); ++i) bitmap.alpha[i] = colours[i * stride + 3];
  return bitmap;
}

Bitmap oriented(Bitmap bitmap, int orientation) {
  if (orientation <= upright || orientation > max_orientation) return bitmap;
  const auto width = static_cast<std::size_t>(bitmap.width);
  const auto height = static_cast<std::size_t>(bitmap.height);
  bitmap.grey = upright_values(bitmap.grey, width, height, orientation);
  if (!bitmap.alpha.empty())
    bitmap.alpha = upright_values(bitmap.alpha, width, height, orientation);
  if (orientation >= 5) std::swap(bitmap.width, bitmap.height);
  return bitmap;
}

bool is_photo(const Bitmap& bitmap) {
  // Black, white and two greys hold nearly all pixels of a drawing; each may be blurred by a JPEG
  // over one of 32 bins. Soft edges of small drawings take up to 15 % of the pixels.
  constexpr std::size_t bin_levels = 8, drawing_bins = 4;
  constexpr double drawing_share = 0.85;
  std::array<std::size_t, 256 / bin_levels> bins{};
  for (std::size_t i = 0; i < bitmap.grey.size(); ++i)
    if (bitmap.is_visible(i)) ++bins[bitmap.grey_over(i, white) / bin_levels];
  const std::size_t visible = std::accumulate(bins.begin(), bins.end(), std::size_t{0});
  std::sort(bins.begin(), bins.end(), std::greater<>());
  const std::size_t few =
      std::accumulate(bins.begin(), bins.begin() + drawing_bins, std::size_t{0});
  return static_cast<double>(few) < drawing_share * static_cast<double>(visible);
}

}  // namespace lamplock::model
