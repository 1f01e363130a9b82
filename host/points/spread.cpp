#include "host/points/spread.hpp"

#include <algorithm>
#include <cmath>

#include "host/geometry/limits.hpp"

namespace lamplock::points {

Spread spread_along(double length_mm, const SpreadOptions& options, std::size_t so_far,
                    const char* where) {
  // A distance that does not fit by rounding only counts as fitting.
  constexpr double rounding = 1e-9;
  const double fits = length_mm / options.wanted_mm;
  const double parts = std::max(1.0, std::floor(fits + rounding * std::max(1.0, fits)));
  geometry::require_count(static_cast<double>(so_far) + parts, where);
  Spread spread{0, length_mm / parts, static_cast<std::size_t>(parts)};
  if (!(length_mm > 0)) return spread;
  if (options.closed) {
    const double offset = std::fmod(options.twist_mm, spread.distance_mm);
    spread.first_mm = offset < 0 ? offset + spread.distance_mm : offset;
  } else if (options.end_points) {
    ++spread.count;
  } else {
    spread.first_mm = spread.distance_mm / 2;
  }
  return spread;
}

}  // namespace lamplock::points
