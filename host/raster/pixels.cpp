#include "host/raster/pixels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/error.hpp"
#include "shared/wire/runs.hpp"

namespace lamplock::raster {
namespace {

constexpr double max_grey = 255, full_power = 65'535;

/// Calls `take(source, share)` for the sources that destination `i` of `to` covers; the sum of the
/// shares is 1.
template <class Take>
void for_covered(std::size_t i, std::size_t to, std::size_t from, const Take& take) {
  if (from == to) return take(i, 1.0);
  const double scale = static_cast<double>(from) / static_cast<double>(to);
  const double low = static_cast<double>(i) * scale, high = low + scale;
  for (auto s = static_cast<std::size_t>(low); s < from && static_cast<double>(s) < high; ++s) {
    const auto at = static_cast<double>(s);
    take(s, (std::min(high, at + 1) - std::max(low, at)) / scale);
  }
}

/// Row `row` of `rows`, from the top, as wide as the picture. Transparent pixels get the grey of
/// power 0, `dark`.
std::vector<double> mean_row(const model::Bitmap& bitmap, std::size_t row, std::size_t rows,
                             std::uint8_t dark) {
  const auto width = static_cast<std::size_t>(bitmap.width);
  std::vector<double> mean(width);
  for_covered(row, rows, static_cast<std::size_t>(bitmap.height),
              [&](std::size_t source, double share) {
                for (std::size_t x = 0; x < width; ++x)
                  mean[x] += share * bitmap.grey_over(source * width + x, dark);
              });
  return mean;
}

void check(const model::Bitmap& bitmap, std::size_t columns, std::size_t rows,
           const PowerRange& range) {
  if (bitmap.width <= 0 || bitmap.height <= 0 || columns == 0 || rows == 0)
    throw Error(Exit::bad_input, "picture", "it has no pixels", "give a picture");
  if (!(range.lightest >= 0 && range.lightest <= range.black && range.black <= 1))
    throw Error(Exit::bad_input, "power",
                fmt::format("{:g} to {:g} %", 100 * range.lightest, 100 * range.black),
                "give 0 to 100 %, the lower one first");
}

}  // namespace

std::uint16_t power_of_run(double power) {
  const auto wanted = static_cast<std::uint16_t>(std::lround(power * full_power));
  return wire::run_power(wire::max_run(wanted, 1));
}

Pixels make_pixels(const model::Bitmap& bitmap, std::size_t columns, std::size_t rows,
                   const PowerRange& range) {
  check(bitmap, columns, rows, range);
  Pixels pixels{columns, rows, std::vector<std::uint16_t>(columns * rows)};
  const auto power = [&range](double grey) {
    const double share = (range.invert ? grey : max_grey - grey) / max_grey;
    return share <= 0 ? std::uint16_t{0}
                      : power_of_run(range.lightest + share * (range.black - range.lightest));
  };
  for (std::size_t row = 0; row < rows; ++row) {
    const std::vector<double> grey =
        mean_row(bitmap, rows - 1 - row, rows, range.invert ? model::black : model::white);
    for (std::size_t column = 0; column < columns; ++column) {
      double mean = 0;
      for_covered(column, columns, grey.size(),
                  [&](std::size_t source, double share) { mean += share * grey[source]; });
      // Rounding must not make the mean of white pixels darker than white.
      constexpr double rounding = 1e-9;
      const double near = std::round(mean);
      pixels.power[row * columns + column] =
          power(std::abs(mean - near) < rounding * max_grey ? near : mean);
    }
  }
  return pixels;
}

}  // namespace lamplock::raster
