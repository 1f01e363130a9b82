// Equal distances along a line: number of points, and position of the first. Called by slice() for
// contours and divide() for curves.
#pragma once

#include <cstddef>

namespace lamplock::points {

/// Points at first_mm + i * distance_mm along the line, i < count.
struct Spread {
  double first_mm = 0, distance_mm = 0;
  std::size_t count = 1;
};

struct SpreadOptions {
  double wanted_mm = 0.1;   ///< greater than 0
  bool closed = false;      ///< the end is the start and gets no second point
  double twist_mm = 0;      ///< closed: position of the first point, modulo the distance
  bool end_points = false;  ///< open: points at both ends, otherwise half a distance from them
};

/// The minimum distance that divides `length_mm` evenly and is not below the wanted one; a shorter
/// line counts as one distance. Throws Error (bad_input, from `where`) if there would be too many
/// points together with the existing `so_far`.
Spread spread_along(double length_mm, const SpreadOptions& options, std::size_t so_far,
                    const char* where);

}  // namespace lamplock::points
