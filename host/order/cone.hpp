// The cone of the beam. In: two points. Out: whether a defect at one shadows the other. Called by
// all code for the shadow rule (shadow.hpp).
//
// The beam comes from +z and is focused under a half angle, so a defect shadows the points inside
// the cone that opens downwards from it. Points of equal height never shadow each other.
#pragma once

#include "host/geometry/point.hpp"

namespace lamplock::order {

/// Default half angle of the beam's cone, degrees.
inline constexpr double default_half_angle_deg = 20;

/// True if a point `below` mm under the tip of a cone and x, y mm beside it lies inside the cone.
inline bool is_under(double below, double x, double y, double tangent) {
  if (below <= 0) return false;
  const double radius = below * tangent;
  return x * x + y * y < radius * radius;
}

/// True if a defect at `upper` shadows `lower`: then `lower` must be fired before it.
inline bool shadows(const geometry::Point& upper, const geometry::Point& lower, double tangent) {
  return is_under(upper.z - lower.z, lower.x - upper.x, lower.y - upper.y, tangent);
}

/// Tangent of a half angle in degrees. Throws Error (bad_input) unless it is from 0 (no shadows) to
/// less than 90.
double cone_tangent(double half_angle_deg);

}  // namespace lamplock::order
