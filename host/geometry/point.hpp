// A point in millimetres, used by the host's rooms model, points, order and job.
#pragma once

#include <vector>

namespace lamplock::geometry {

/// mm, right-handed, z up, beam from +z.
struct Point {
  double x = 0, y = 0, z = 0;
  friend bool operator==(const Point&, const Point&) = default;
};
using PointCloud = std::vector<Point>;

bool is_finite(const Point& point);

}  // namespace lamplock::geometry
