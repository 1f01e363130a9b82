// The cone of the beam. Comes in: two points. Goes out: whether a defect at one keeps the beam from
// the other. Called by everything that knows of the shadow rule (shadow.hpp).
//
// The beam comes from +z and is focused under a half angle, so a defect shadows the points inside
// the cone that opens downwards from it. Points of equal height never shadow each other.
#pragma once

#include "host/points/point.hpp"

namespace lamplock::order {

/// Half angle of the beam's cone where nothing else is said, degrees.
inline constexpr double default_half_angle_deg = 20;

/// Whether a place `below` lower than the tip of a cone and off by x, y lies inside it.
inline bool is_under(double below, double x, double y, double tangent) {
  if (below <= 0) return false;
  const double radius = below * tangent;
  return x * x + y * y < radius * radius;
}

/// Whether a defect at `upper` shadows `lower`: then `lower` has to be fired before it.
inline bool shadows(const points::Point& upper, const points::Point& lower, double tangent) {
  return is_under(upper.z - lower.z, lower.x - upper.x, lower.y - upper.y, tangent);
}

/// Tangent of a half angle in degrees. Throws Error (bad_input) unless it is from 0 (nothing is
/// shadowed) to less than 90.
double cone_tangent(double half_angle_deg);

}  // namespace lamplock::order
