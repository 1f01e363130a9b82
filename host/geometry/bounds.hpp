// The box round a cloud. In: points. Out: lowest and highest corner. Called by the readers'
// transforms, the discretisers and the check of the work space.
#pragma once

#include <span>

#include "host/geometry/point.hpp"

namespace lamplock::geometry {

/// An axis-parallel box in mm, both corners included.
struct Bounds {
  Point low, high;

  /// The longest of the three sides, mm.
  double max_side() const;
  Point centre() const;
  bool contains(const Point& point) const;
};

/// The bounding box of `cloud`; all zero if the cloud is empty.
Bounds bounds(std::span<const Point> cloud);

}  // namespace lamplock::geometry
