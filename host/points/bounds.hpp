// The box round a cloud. Comes in: points. Goes out: lowest and highest corner. Called by the
// readers' transforms, the discretisers and the check of the work space.
#pragma once

#include <span>

#include "host/points/point.hpp"

namespace lamplock::points {

/// An axis-parallel box in mm, both corners included.
struct Bounds {
  Point low, high;

  /// The longest of the three sides, mm.
  double longest_side() const;
  Point centre() const;
  bool contains(const Point& point) const;
};

/// The smallest box round `cloud`; all zero if the cloud is empty.
Bounds bounds(std::span<const Point> cloud);

}  // namespace lamplock::points
