// What spacing a cloud really has: the proof after any discretiser, weld and transformation. In: a
// cloud. Out: the smallest distance, duplicates, the distances of nearest neighbours. Called by the
// command line and the report. Budget: a million points in about a second.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "host/geometry/point.hpp"

namespace lamplock::points {

/// Distances in mm; all are 0 for clouds of fewer than two points.
struct SpacingReport {
  std::size_t points = 0;
  std::size_t duplicates = 0;         // points at exactly the position of an earlier one
  double min_mm = 0;                  // between any two points; 0 if there are duplicates
  std::size_t first = 0, second = 0;  // indices of two points at this distance
  /// Distance of each position to the nearest other one (duplicates are one position).
  double mean_mm = 0, max_mm = 0;
  /// counts[i]: positions with i * bin_mm <= nearest distance < (i + 1) * bin_mm; the last bin
  /// also has all larger ones.
  double bin_mm = 0;
  std::vector<std::size_t> counts;
};

/// Exact. The histogram ends at about three times the mean. Throws Error (bad_input) for a
/// coordinate that is not finite.
SpacingReport spacing_of(std::span<const geometry::Point> cloud);

}  // namespace lamplock::points
