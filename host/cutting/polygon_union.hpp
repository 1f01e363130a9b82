// Unions of polygons that cross themselves or each other, by libpolyclipping.
//
// In:  polygons, which winding numbers are inside. Out: polygons that cross nothing.
// Who: simple_contours().
#pragma once

#include <vector>

#include "host/cutting/edge.hpp"

namespace lamplock::cutting {

using Polygon = std::vector<Vec>;

/// Which points are inside, by how often the polygons run around them counter-clockwise.
enum class FillRule { non_zero, positive, negative };

/// Results are rounded to this; a thousandth of the resolution of machines.
inline constexpr double union_grid_mm = 1e-6;

/// The boundary of the inside: outer polygons counter-clockwise, holes clockwise. Vertices on
/// straight sides remain. Throws Error (bad_input) for coordinates that are too large.
std::vector<Polygon> united(const std::vector<Polygon>& polygons, FillRule rule);

}  // namespace lamplock::cutting
