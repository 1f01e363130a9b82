// Vector arithmetic of points. Called by readers of models and by discretisers.
#pragma once

#include <cmath>
#include <numbers>

#include "host/geometry/point.hpp"

namespace lamplock::geometry {

inline constexpr double radians_per_degree = std::numbers::pi / 180;

inline Point difference(const Point& p, const Point& q) {
  return {p.x - q.x, p.y - q.y, p.z - q.z};
}
inline Point times(const Point& p, double factor) {
  return {p.x * factor, p.y * factor, p.z * factor};
}
inline double dot(const Point& p, const Point& q) { return p.x * q.x + p.y * q.y + p.z * q.z; }
inline Point cross(const Point& p, const Point& q) {
  return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
}
inline double norm(const Point& p) { return std::hypot(p.x, p.y, p.z); }
inline double square_of_distance(const Point& p, const Point& q) {
  const double x = p.x - q.x, y = p.y - q.y, z = p.z - q.z;
  return x * x + y * y + z * z;
}

}  // namespace lamplock::geometry
