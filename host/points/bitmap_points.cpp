#include "host/points/bitmap_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "host/error.hpp"
#include "host/geometry/affine.hpp"
#include "host/geometry/limits.hpp"
#include "host/geometry/random.hpp"
#include "host/geometry/vector.hpp"
#include "host/number_text.hpp"

namespace lamplock::points {
namespace {

/// Sums of all pixels above and left of a corner, so that the sum of a box needs four reads.
template <class Sum>
class PixelSums {
 public:
  PixelSums() = default;
  /// `value(pixel)` for every pixel of a picture.
  template <class Value>
  PixelSums(int width, int height, const Value& value)
      : stride_(static_cast<std::size_t>(width) + 1),
        sums_(stride_ * (static_cast<std::size_t>(height) + 1), 0) {
    const std::size_t pixels = (stride_ - 1) * static_cast<std::size_t>(height);
    for (std::size_t i = 0; i < pixels; ++i) {
      const std::size_t corner = (i / (stride_ - 1) + 1) * stride_ + i % (stride_ - 1) + 1;
      sums_[corner] =
          value(i) + sums_[corner - 1] + sums_[corner - stride_] - sums_[corner - stride_ - 1];
    }
  }

  /// Of the pixels left <= x < right, top <= y < bottom.
  Sum of(std::size_t left, std::size_t right, std::size_t top, std::size_t bottom) const {
    return sums_[bottom * stride_ + right] - sums_[bottom * stride_ + left] -
           sums_[top * stride_ + right] + sums_[top * stride_ + left];
  }

 private:
  std::size_t stride_ = 0;
  std::vector<Sum> sums_;
};

std::size_t to_index(double value) { return static_cast<std::size_t>(value); }

/// The grid along one axis, round 0.
struct GridAxis {
  GridAxis(double length_mm, double spacing_mm)
      : count(std::max(1.0, std::floor(length_mm / spacing_mm + 1e-9))),
        first_mm(-(count - 1) / 2 * spacing_mm),
        spacing(spacing_mm),
        max_shift_mm(std::min(spacing_mm, length_mm)) {}

  double position(std::size_t i) const { return first_mm + static_cast<double>(i) * spacing; }

  double count, first_mm, spacing;
  double max_shift_mm;  ///< from end to end; a point stays within the length
};

/// Pixels along one side of the picture, whose middle is 0.
struct PixelSide {
  /// The pixels of a grid point: begin, end, and the one that it is in.
  struct Covered {
    std::size_t begin, end, middle;
  };

  PixelSide(int pixels, double length_mm, double spacing_mm)
      : pixel_mm(length_mm / pixels),
        half_mm(length_mm / 2),
        reach_mm(spacing_mm / 2),
        last_pixel(pixels - 1) {}

  /// The pixels in the square of a grid point; at least one.
  Covered at(double position) const {
    // Rounding must not move an edge of a square from an edge of a pixel into the next pixel.
    constexpr double rounding = 1e-6;
    const double low = (position - reach_mm + half_mm) / pixel_mm + rounding;
    const double high = (position + reach_mm + half_mm) / pixel_mm - rounding;
    const double middle = std::clamp(std::floor((low + high) / 2), 0.0, last_pixel);
    if (high - low <= 1) return {to_index(middle), to_index(middle) + 1, to_index(middle)};
    const double first = std::clamp(std::floor(low), 0.0, middle);
    const double last = std::clamp(std::floor(high), middle, last_pixel);
    return {to_index(first), to_index(last) + 1, to_index(middle)};
  }

  bool contains(double position) const { return std::abs(position) <= half_mm; }

  double pixel_mm, half_mm, reach_mm, last_pixel;
};

void require_valid(const BitmapOptions& options) {
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
}

/// The frame's plane: unit vectors, of which the first is along the lower side.
struct PicturePlane {
  explicit PicturePlane(const PictureFrame& frame)
      : centre(frame.centre),
        width_mm(geometry::norm(frame.right)),
        along(geometry::times(frame.right, 1 / width_mm)),
        lean_mm(geometry::dot(frame.up, along)),
        normal(frame.normal) {
    const geometry::Point upright = geometry::difference(frame.up, geometry::times(along, lean_mm));
    height_mm = geometry::norm(upright);
    across = geometry::times(upright, 1 / height_mm);
    // Rounding of a rotation.
    if (std::abs(lean_mm) < 1e-9 * (width_mm + height_mm)) lean_mm = 0;
  }

  geometry::Point at(double x, double y, double depth) const {
    return geometry::Affine{along, across, normal, centre}({x, y, depth});
  }

  geometry::Point centre;
  double width_mm;
  geometry::Point along;
  double lean_mm;  ///< the left side leans to the right by this, after rotation and uneven scale
  geometry::Point normal, across{};
  double height_mm = 0;
};

/// What a grid point is in the picture.
struct Sample {
  double grey = 0;   ///< mean of the visible pixels over the background, 0..255
  double alpha = 0;  ///< of the pixel in which it is, 0..1; 0: no point may be here
};

/// The picture sampled at grid points, row by row from the lowest.
class Grid {
 public:
  Grid(const model::Bitmap& bitmap, const PicturePlane& plane, double spacing_mm,
       std::uint8_t background)
      : bitmap_(bitmap),
        plane_(plane),
        across_(plane.width_mm + std::abs(plane.lean_mm), spacing_mm),
        up_(plane.height_mm, spacing_mm),
        columns_(bitmap.width, plane.width_mm, spacing_mm),
        rows_(bitmap.height, plane.height_mm, spacing_mm),
        pixel_rows_(static_cast<std::size_t>(bitmap.height)) {
    geometry::require_count(across_.count * up_.count, "bitmap");
    grey_ = {bitmap.width, bitmap.height, [&](std::size_t i) {
               return bitmap.is_visible(i) ? bitmap.grey_over(i, background) : std::uint8_t{0};
             }};
    if (bitmap.alpha.empty()) return;
    visible_ = {bitmap.width, bitmap.height,
                [&](std::size_t i) { return bitmap.is_visible(i) ? 1U : 0U; }};
  }

  std::size_t columns() const { return to_index(across_.count); }
  std::size_t rows() const { return to_index(up_.count); }

  /// Moves all grid points by parts of the spacing, from -0.5 to 0.5, and out of the picture's
  /// plane.
  void set_layer(double shift_across, double shift_up, double depth_mm) {
    shift_across_ = shift_across * across_.max_shift_mm;
    shift_up_ = shift_up * up_.max_shift_mm;
    depth_mm_ = depth_mm;
  }

  geometry::Point place(std::size_t i, std::size_t j) const {
    return plane_.at(across_.position(i) + shift_across_, up_.position(j) + shift_up_, depth_mm_);
  }

  Sample sample(std::size_t i, std::size_t j) const {
    const double y = up_.position(j) + shift_up_;
    const double x = across_.position(i) + shift_across_ - plane_.lean_mm * (y / plane_.height_mm);
    if (plane_.lean_mm != 0 && !columns_.contains(x)) return {};
    const auto [left, right, column] = columns_.at(x);
    const auto [bottom, top, row] = rows_.at(y);  // counted from the bottom of the picture
    const std::size_t first = pixel_rows_ - top, last = pixel_rows_ - bottom;
    const auto sum = static_cast<double>(grey_.of(left, right, first, last));
    const std::size_t all = (right - left) * (top - bottom);
    if (bitmap_.alpha.empty()) return {sum / static_cast<double>(all), 1};
    const std::size_t pixel =
        (pixel_rows_ - 1 - row) * static_cast<std::size_t>(bitmap_.width) + column;
    if (!bitmap_.is_visible(pixel)) return {};
    const std::size_t count = visible_.of(left, right, first, last);
    return {sum / static_cast<double>(count), bitmap_.alpha[pixel] / double{model::opaque}};
  }

 private:
  const model::Bitmap& bitmap_;
  PicturePlane plane_;
  GridAxis across_, up_;
  PixelSide columns_, rows_;
  std::size_t pixel_rows_;
  PixelSums<std::uint64_t> grey_;
  PixelSums<std::uint32_t> visible_;
  double shift_across_ = 0, shift_up_ = 0, depth_mm_ = 0;
};

void threshold_layer(const Grid& grid, const BitmapOptions& options, geometry::PointCloud& cloud) {
  for (std::size_t j = 0; j < grid.rows(); ++j) {
    for (std::size_t i = 0; i < grid.columns(); ++i) {
      const Sample sample = grid.sample(i, j);
      const bool dark = sample.grey < options.threshold;
      if (sample.alpha > 0 && dark != options.invert) cloud.push_back(grid.place(i, j));
    }
  }
}

/// Wanted share of points at a sample. Of transparent pixels the lowest density is less too.
double density(const Sample& sample, const BitmapOptions& options) {
  if (sample.alpha <= 0) return 0;
  const double bright = sample.grey / model::white;
  return options.tone->density(options.invert ? bright : 1 - bright) -
         options.tone->lowest * (1 - sample.alpha);
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

void tone_layer(const Grid& grid, const BitmapOptions& options, geometry::Random random,
                geometry::PointCloud& cloud) {
  Dither dither(grid.columns(), random);
  std::vector<double> wanted(grid.columns());
  for (std::size_t j = 0; j < grid.rows(); ++j) {
    for (std::size_t i = 0; i < grid.columns(); ++i)
      wanted[i] = density(grid.sample(i, j), options);
    const std::size_t begin = cloud.size();
    dither.row(
        grid.columns(), [&](std::size_t i) { return wanted[i]; },
        [&](std::size_t i) { cloud.push_back(grid.place(i, j)); });
    if (j % 2 != 0) std::reverse(cloud.begin() + static_cast<std::ptrdiff_t>(begin), cloud.end());
  }
}

/// The shift of layer k along one axis, -0.5..0.5 of the spacing; 0 for the first. Multiples of a
/// badly approximable number never come close to each other.
double shift_of(int k, double ratio) {
  const double turns = k * ratio;
  return turns - std::floor(turns + 0.5);
}

/// Grid points to look at, so that pictures without points end in time as well.
void require_work(const Grid& grid, int layers) {
  constexpr double max_samples = 100.0 * geometry::max_points;
  const double samples = static_cast<double>(grid.columns()) * static_cast<double>(grid.rows());
  if (samples * layers <= max_samples) return;
  throw Error(Exit::bad_input, "bitmap",
              fmt::format("{} of {:.3g} grid points",
                          count_text(static_cast<std::size_t>(layers), "layer"), samples),
              "use a larger spacing, a smaller size or fewer layers");
}

}  // namespace

LayeredPoints bitmap_points(const model::Bitmap& bitmap, const PictureFrame& frame,
                            const BitmapOptions& options) {
  require_valid(options);
  const PicturePlane plane(frame);
  geometry::require_positive(plane.width_mm, "bitmap", "width");
  geometry::require_positive(plane.height_mm, "bitmap", "height");
  Grid grid(bitmap, plane, options.spacing_mm, options.invert ? model::black : model::white);
  require_work(grid, options.layers);
  constexpr double golden_ratio = 0.618033988749895, silver_ratio = 0.414213562373095;
  const geometry::Random seeds(options.seed);
  LayeredPoints layered;
  geometry::PointCloud& cloud = layered.points;
  for (int k = 0; k < options.layers; ++k) {
    layered.first.push_back(cloud.size());
    grid.set_layer(shift_of(k, golden_ratio), shift_of(k, silver_ratio),
                   (k - (options.layers - 1) / 2.0) * options.layer_mm);
    if (options.tone)
      tone_layer(grid, options, geometry::Random(seeds.fork(static_cast<unsigned>(k))), cloud);
    else
      threshold_layer(grid, options, cloud);
    geometry::require_count(static_cast<double>(cloud.size()), "bitmap");
  }
  return layered;
}

}  // namespace lamplock::points
