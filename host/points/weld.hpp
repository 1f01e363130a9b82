// Weld: two defects too close together crack the glass, so no two points may be closer than the
// lens allows (0.09 mm for f = 43 mm, 0.13 mm for f = 70 mm: "Mechatronic positioning of a pulsed
// laser beam in devices forming 3-D objects in glass"). In: a cloud. Out: the same cloud, in the
// same order, without the points that came too close to an earlier one. Called after the
// discretisers; never for point lists, which are engraved as given.
#pragma once

#include <cstddef>

#include "host/geometry/point.hpp"
#include "host/points/layered_points.hpp"

namespace lamplock::points {

struct WeldResult {
  geometry::PointCloud points;
  std::size_t removed = 0;
};

/// Removes every point that is closer than `min_distance_mm` to a kept point before it, so that no
/// two points of the result are closer than that; the first `always_kept` points are kept at any
/// distance. Deterministic, time and memory linear for clouds of bounded density. 0 keeps all
/// points. Coordinates must be finite. Throws Error (bad_input) for a distance that is negative or
/// not finite.
WeldResult weld(geometry::PointCloud cloud, double min_distance_mm, std::size_t always_kept = 0);

/// The same in each layer alone: points of different layers never remove each other.
WeldResult weld_in_layers(const LayeredPoints& cloud, double min_distance_mm);

}  // namespace lamplock::points
