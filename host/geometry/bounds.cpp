#include "host/geometry/bounds.hpp"

#include <algorithm>

namespace lamplock::geometry {

double Bounds::max_side() const {
  return std::max({high.x - low.x, high.y - low.y, high.z - low.z});
}

Point Bounds::centre() const {
  return {low.x + (high.x - low.x) / 2, low.y + (high.y - low.y) / 2, low.z + (high.z - low.z) / 2};
}

bool Bounds::contains(const Point& point) const {
  return point.x >= low.x && point.x <= high.x && point.y >= low.y && point.y <= high.y &&
         point.z >= low.z && point.z <= high.z;
}

Bounds bounds(std::span<const Point> cloud) {
  if (cloud.empty()) return {};
  Bounds box{cloud.front(), cloud.front()};
  for (const Point& point : cloud) {
    box.low = {std::min(box.low.x, point.x), std::min(box.low.y, point.y),
               std::min(box.low.z, point.z)};
    box.high = {std::max(box.high.x, point.x), std::max(box.high.y, point.y),
                std::max(box.high.z, point.z)};
  }
  return box;
}

}  // namespace lamplock::geometry
