#include "host/points/bitmap_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "host/error.hpp"
#include "host/points/limits.hpp"

namespace lamplock::points {
namespace {

/// Sums of all pixels above and left of a corner, so that the mean of a square costs four reads.
class PixelSums {
 public:
  explicit PixelSums(const model::Bitmap& bitmap)
      : stride_(static_cast<std::size_t>(bitmap.width) + 1),
        sums_(stride_ * (static_cast<std::size_t>(bitmap.height) + 1), 0) {
    for (std::size_t i = 0; i < bitmap.grey.size(); ++i) {
      const std::size_t corner = (i / (stride_ - 1) + 1) * stride_ + i % (stride_ - 1) + 1;
      sums_[corner] = bitmap.grey[i] + sums_[corner - 1] + sums_[corner - stride_] -
                      sums_[corner - stride_ - 1];
    }
  }

  /// Mean grey of the pixels left <= x < right, top <= y < bottom.
  double mean(std::size_t left, std::size_t right, std::size_t top, std::size_t bottom) const {
    const std::uint64_t sum = sums_[bottom * stride_ + right] - sums_[bottom * stride_ + left] -
                              sums_[top * stride_ + right] + sums_[top * stride_ + left];
    return static_cast<double>(sum) / static_cast<double>((right - left) * (bottom - top));
  }

 private:
  std::size_t stride_;
  std::vector<std::uint64_t> sums_;
};

/// Grid points along one side of the picture and the pixels each of them stands for.
struct Side {
  Side(int pixels, double length_mm, double spacing_mm)
      : count(std::max(1.0, std::floor(length_mm / spacing_mm + 1e-9))),
        first_mm(-(count - 1) / 2 * spacing_mm),
        pixel_mm(length_mm / pixels),
        half_mm(length_mm / 2),
        spacing(spacing_mm),
        last_pixel(pixels - 1) {}

  double position(std::size_t i) const { return first_mm + static_cast<double>(i) * spacing; }

  /// First pixel of grid point i's square and the one behind its last; at least one pixel.
  std::pair<std::size_t, std::size_t> pixels(std::size_t i) const {
    // Edges of squares that meet edges of pixels must not slip to the next pixel by rounding.
    constexpr double rounding = 1e-6;
    const double low = (position(i) - spacing / 2 + half_mm) / pixel_mm + rounding;
    const double high = (position(i) + spacing / 2 + half_mm) / pixel_mm - rounding;
    const double middle = std::clamp(std::floor((low + high) / 2), 0.0, last_pixel);
    if (high - low <= 1) return {to_index(middle), to_index(middle) + 1};
    const double first = std::clamp(std::floor(low), 0.0, middle);
    const double last = std::clamp(std::floor(high), middle, last_pixel);
    return {to_index(first), to_index(last) + 1};
  }

  static std::size_t to_index(double value) { return static_cast<std::size_t>(value); }

  double count, first_mm, pixel_mm, half_mm, spacing, last_pixel;
};

void require_valid(const model::Bitmap& bitmap, const BitmapOptions& options) {
  require_positive(options.size_mm, "bitmap", "size");
  require_positive(options.spacing_mm, "bitmap", "spacing");
  require_positive(options.layers, "bitmap", "number of layers");
  if (options.layers > 1) require_positive(options.layer_mm, "bitmap", "layer distance");
  if (options.threshold < 0 || options.threshold > 255) {
    throw Error(Exit::bad_input, "bitmap", fmt::format("threshold {}", options.threshold),
                "give 0 to 255");
  }
  if (bitmap.width <= 0 || bitmap.height <= 0) {
    throw Error(Exit::bad_input, "bitmap", "it has no pixels", "give a picture");
  }
}

/// The points of one layer at z = 0.
PointCloud one_layer(const model::Bitmap& bitmap, const BitmapOptions& options) {
  const double scale = options.size_mm / std::max(bitmap.width, bitmap.height);
  const Side across(bitmap.width, bitmap.width * scale, options.spacing_mm);
  const Side up(bitmap.height, bitmap.height * scale, options.spacing_mm);
  require_count(across.count * up.count, "bitmap");
  const PixelSums sums(bitmap);
  const auto rows = static_cast<std::size_t>(bitmap.height);
  PointCloud cloud;
  for (std::size_t j = 0; j < Side::to_index(up.count); ++j) {
    const auto [bottom, top] = up.pixels(j);  // counted from the bottom of the picture
    for (std::size_t i = 0; i < Side::to_index(across.count); ++i) {
      const auto [left, right] = across.pixels(i);
      const bool dark = sums.mean(left, right, rows - top, rows - bottom) < options.threshold;
      if (dark != options.invert) cloud.push_back({across.position(i), up.position(j), 0});
    }
  }
  return cloud;
}

}  // namespace

PointCloud bitmap_points(const model::Bitmap& bitmap, const BitmapOptions& options) {
  require_valid(bitmap, options);
  const PointCloud layer = one_layer(bitmap, options);
  require_count(static_cast<double>(layer.size()) * options.layers, "bitmap");
  PointCloud cloud;
  cloud.reserve(layer.size() * static_cast<std::size_t>(options.layers));
  for (int k = 0; k < options.layers; ++k) {
    const double z = (k - (options.layers - 1) / 2.0) * options.layer_mm;
    for (const Point& point : layer) cloud.push_back({point.x, point.y, z});
  }
  return cloud;
}

}  // namespace lamplock::points
