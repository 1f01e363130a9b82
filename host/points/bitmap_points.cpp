#include "host/points/bitmap_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "host/error.hpp"
#include "host/geometry/limits.hpp"
#include "host/geometry/random.hpp"

namespace lamplock::points {
namespace {

/// Sums of all pixels above and left of a corner, so that the mean of a square needs four reads.
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

/// Grid points along one side of the picture, each with its pixels.
struct Side {
  Side(int pixels, double length_mm, double spacing_mm)
      : count(std::max(1.0, std::floor(length_mm / spacing_mm + 1e-9))),
        first_mm(-(count - 1) / 2 * spacing_mm),
        pixel_mm(length_mm / pixels),
        half_mm(length_mm / 2),
        spacing(spacing_mm),
        last_pixel(pixels - 1) {}

  double position(std::size_t i) const { return first_mm + static_cast<double>(i) * spacing; }

  /// Begin and end of the pixels in grid point i's square; at least one pixel.
  std::pair<std::size_t, std::size_t> pixels(std::size_t i) const {
    // Rounding must not move an edge of a square from an edge of a pixel into the next pixel.
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
  geometry::require_positive(options.size_mm, "bitmap", "size");
  geometry::require_positive(options.spacing_mm, "bitmap", "spacing");
  geometry::require_positive(options.layers, "bitmap", "number of layers");
  constexpr int max_layers = 10'000;  // a metre at 0.1 mm
  if (options.layers > max_layers) {
    throw Error(Exit::bad_input, "bitmap", fmt::format("{} layers", options.layers),
                fmt::format("give at most {}", max_layers));
  }
  if (options.layers > 1) geometry::require_positive(options.layer_mm, "bitmap", "layer distance");
  if (options.threshold < 0 || options.threshold > 255) {
    throw Error(Exit::bad_input, "bitmap", fmt::format("threshold {}", options.threshold),
                "give 0 to 255");
  }
  if (options.tone) require_valid(*options.tone, "bitmap");
  if (bitmap.width <= 0 || bitmap.height <= 0) {
    throw Error(Exit::bad_input, "bitmap", "it has no pixels", "give a picture");
  }
}

/// The picture sampled at grid points, row by row from the lowest.
class Grid {
 public:
  Grid(const model::Bitmap& bitmap, const BitmapOptions& options)
      : scale_(options.size_mm / std::max(bitmap.width, bitmap.height)),
        across_(bitmap.width, bitmap.width * scale_, options.spacing_mm),
        up_(bitmap.height, bitmap.height * scale_, options.spacing_mm),
        sums_(bitmap),
        pixel_rows_(static_cast<std::size_t>(bitmap.height)) {
    geometry::require_count(across_.count * up_.count, "bitmap");
  }

  std::size_t columns() const { return Side::to_index(across_.count); }
  std::size_t rows() const { return Side::to_index(up_.count); }
  geometry::Point place(std::size_t i, std::size_t j) const {
    return {across_.position(i), up_.position(j), 0};
  }

  /// Mean of the pixels under a grid point, 0..255.
  double grey(std::size_t i, std::size_t j) const {
    const auto [left, right] = across_.pixels(i);
    const auto [bottom, top] = up_.pixels(j);  // counted from the bottom of the picture
    return sums_.mean(left, right, pixel_rows_ - top, pixel_rows_ - bottom);
  }

 private:
  double scale_;
  Side across_, up_;
  PixelSums sums_;
  std::size_t pixel_rows_;
};

/// The points of one layer at z = 0.
geometry::PointCloud threshold_layer(const Grid& grid, const BitmapOptions& options) {
  geometry::PointCloud cloud;
  for (std::size_t j = 0; j < grid.rows(); ++j) {
    for (std::size_t i = 0; i < grid.columns(); ++i) {
      const bool dark = grid.grey(i, j) < options.threshold;
      if (dark != options.invert) cloud.push_back(grid.place(i, j));
    }
  }
  return cloud;
}

/// Wanted share of points, row by row.
std::vector<float> densities(const Grid& grid, const BitmapOptions& options) {
  std::vector<float> wanted;
  wanted.reserve(grid.rows() * grid.columns());
  for (std::size_t j = 0; j < grid.rows(); ++j) {
    for (std::size_t i = 0; i < grid.columns(); ++i) {
      const double bright = grid.grey(i, j) / 255;
      wanted.push_back(
          static_cast<float>(options.tone->density(options.invert ? bright : 1 - bright)));
    }
  }
  return wanted;
}

/// Error diffusion, every other row backwards, with weights and threshold moved at random.
class Dither {
  /// With less, medium grey becomes a chequerboard; with more, greys become grainy.
  static constexpr double threshold_noise = 0.6;

 public:
  Dither(std::size_t columns, geometry::Random random)
      : random_(random), here_(columns + 2, 0), ahead_(columns + 2, 0) {
    for (double& error : here_) error = random_.uniform() - 0.5;  // differs from layer to layer
  }

  /// Calls `point(i)` for every point of the next row, in the order of i or against it.
  template <class Row, class Found>
  void row(std::size_t columns, const Row& wanted, const Found& point) {
    for (std::size_t k = 0; k < columns; ++k) {
      const std::size_t i = backwards_ ? columns - 1 - k : k;
      const double value = wanted(i) + here_[i + 1];
      // Pure black and white stay pure: an error stops there.
      const bool pure = wanted(i) <= 0 || wanted(i) >= 1;
      const double level = 0.5 + threshold_noise * (random_.uniform() - 0.5);
      const bool dot = pure ? wanted(i) >= 1 : value >= level;
      if (dot) point(i);
      if (!pure) spread(i + 1, value - (dot ? 1 : 0));
    }
    here_.swap(ahead_);
    std::fill(ahead_.begin(), ahead_.end(), 0.0);
    backwards_ = !backwards_;
  }

 private:
  /// 7/16 to the next point, 3/16, 5/16 and 1/16 to the next row: two pairs, in each of which a
  /// random part of the smaller weight is exchanged.
  void spread(std::size_t at, double error) {
    const double large = (random_.uniform() - 0.5) * 5 / 16, small = (random_.uniform() - 0.5) / 16;
    const std::size_t next = backwards_ ? at - 1 : at + 1, last = backwards_ ? at + 1 : at - 1;
    here_[next] += error * (7.0 / 16 + large);
    ahead_[at] += error * (5.0 / 16 - large);
    ahead_[last] += error * (3.0 / 16 + small);
    ahead_[next] += error * (1.0 / 16 - small);
  }

  geometry::Random random_;
  std::vector<double> here_, ahead_;  // errors; one more at each end
  bool backwards_ = false;
};

geometry::PointCloud tone_layer(const Grid& grid, const std::vector<float>& wanted,
                                geometry::Random random) {
  geometry::PointCloud cloud;
  Dither dither(grid.columns(), random);
  for (std::size_t j = 0; j < grid.rows(); ++j) {
    const std::size_t first = j * grid.columns(), begin = cloud.size();
    dither.row(
        grid.columns(), [&](std::size_t i) { return double{wanted[first + i]}; },
        [&](std::size_t i) { cloud.push_back(grid.place(i, j)); });
    if (j % 2 != 0) std::reverse(cloud.begin() + static_cast<std::ptrdiff_t>(begin), cloud.end());
  }
  return cloud;
}

/// Converts coordinates along the picture's own axes (right, up, layer).
geometry::Point in_plane(const geometry::Point& point, double layer_mm, Plane plane) {
  switch (plane) {
    case Plane::xz:
      return {point.x, layer_mm, point.y};
    case Plane::yz:
      return {layer_mm, point.x, point.y};
    case Plane::xy:
      break;
  }
  return {point.x, point.y, layer_mm};
}

}  // namespace

geometry::PointCloud bitmap_points(const model::Bitmap& bitmap, const BitmapOptions& options) {
  require_valid(bitmap, options);
  const Grid grid(bitmap, options);
  const std::vector<float> wanted = options.tone ? densities(grid, options) : std::vector<float>{};
  geometry::PointCloud layer =
      options.tone ? geometry::PointCloud{} : threshold_layer(grid, options);
  const geometry::Random seeds(options.seed);
  geometry::PointCloud cloud;
  for (int k = 0; k < options.layers; ++k) {
    if (options.tone)
      layer = tone_layer(grid, wanted, geometry::Random(seeds.fork(static_cast<unsigned>(k))));
    geometry::require_count(static_cast<double>(cloud.size() + layer.size()), "bitmap");
    const double depth = (k - (options.layers - 1) / 2.0) * options.layer_mm;
    for (const geometry::Point& point : layer)
      cloud.push_back(in_plane(point, depth, options.plane));
  }
  return cloud;
}

}  // namespace lamplock::points
