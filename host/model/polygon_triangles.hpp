// Splits polygons of mesh files into triangles. In: corners in space, nearly in a plane. Out:
// triangles of the same orientation. Called by the OBJ and PLY readers.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "host/geometry/point.hpp"

namespace lamplock::model {

/// Concave polygons with at most so many corners are split exactly; larger ones must be convex.
inline constexpr std::size_t max_concave_corners = 2000;

/// Triangles as indices of corners: n - 2 for n corners, none for less than three. A convex polygon
/// becomes a fan from its first corner, a concave one loses ears. Polygons that cross themselves
/// give any triangles. Empty for a concave polygon of too many corners. Time linear for convex
/// polygons, quadratic for concave ones.
std::vector<std::array<std::size_t, 3>> triangles_of(std::span<const geometry::Point> polygon);

}  // namespace lamplock::model
