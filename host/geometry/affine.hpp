// Affine maps of space, for the placement of DXF blocks, SVG groups and slicing frames.
//
// In:  points, maps. Out: points, maps; plain arithmetic.
// Who: the readers of curves, transformed() of curves, slice().
#pragma once

#include "host/geometry/point.hpp"

namespace lamplock::geometry {

/// p -> x * p.x + y * p.y + z * p.z + offset: the images of the three unit vectors, and of the
/// origin. By default the identity.
struct Affine {
  Point x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  Point offset{};

  /// Maps a direction, a difference of two points.
  Point turn(const Point& v) const {
    return {x.x * v.x + y.x * v.y + z.x * v.z, x.y * v.x + y.y * v.y + z.y * v.z,
            x.z * v.x + y.z * v.y + z.z * v.z};
  }
  Point operator()(const Point& p) const {
    const Point turned = turn(p);
    return {turned.x + offset.x, turned.y + offset.y, turned.z + offset.z};
  }
  /// First `inner`, then this.
  Affine operator*(const Affine& inner) const {
    return {turn(inner.x), turn(inner.y), turn(inner.z), (*this)(inner.offset)};
  }
  friend bool operator==(const Affine&, const Affine&) = default;
};

inline Affine moved(double x, double y, double z) {
  Affine map;
  map.offset = {x, y, z};
  return map;
}
inline Affine scaled(double x, double y, double z) { return {{x, 0, 0}, {0, y, 0}, {0, 0, z}, {}}; }

/// Counter-clockwise seen against the axis. Quarter turns are exact.
Affine turned_about_x(double degrees);
Affine turned_about_y(double degrees);
Affine turned_about_z(double degrees);

/// The inverse of a map that only turns and moves.
Affine turned_back(const Affine& turn);

}  // namespace lamplock::geometry
