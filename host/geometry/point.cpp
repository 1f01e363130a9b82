#include "host/geometry/point.hpp"

#include <cmath>

namespace lamplock::geometry {

bool is_finite(const Point& point) {
  return std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z);
}

}  // namespace lamplock::geometry
