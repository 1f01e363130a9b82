// How much of a surface a cloud leaves empty: faces along rays, caps of slices, triangles that were
// left out. In: a mesh in mm and its points. Out: a share of its area. Called by the host's
// run/mesh_points after every method.
#pragma once

#include <span>

#include "host/geometry/point.hpp"
#include "host/model/mesh.hpp"

namespace lamplock::points {

/// The share (0..1) of the surface that is `reach_mm` or more away from all points, measured at
/// 20 000 places of equal area: its standard error is 0.07 % at 1 %. 0 for a mesh without area.
/// Time is linear in triangles and points. Throws Error (bad_input) for a reach that is not
/// positive.
double empty_share(const model::Mesh& mesh, std::span<const geometry::Point> cloud,
                   double reach_mm);

}  // namespace lamplock::points
