// Parallel rays ("Mechatronic positioning of a pulsed laser beam in devices forming 3-D objects in
// glass"): a grid of rays goes through the mesh and every hit becomes a point, both facings, in one
// pass. In: a mesh in mm. Out: points in the order of the triangles. Called by the command line;
// weld() follows, because faces seen at a flat angle give dense rows.
//
// The triangles are rasterised into the grid. Their corners are rounded to a lattice of at least
// 2^9 cells per pitch (for usual sizes 10 nm or finer) and edges are decided in integers by the
// top-left rule, so a ray through a shared edge or corner hits exactly one of the triangles there:
// a closed mesh gives an even number of hits on every ray.
#pragma once

#include "host/geometry/axis.hpp"
#include "host/geometry/point.hpp"
#include "host/model/mesh.hpp"

namespace lamplock::points {

struct RayOptions {
  double pitch_mm = 0.1;                         // distance of neighbouring rays in both directions
  geometry::Axis direction = geometry::Axis::z;  // of all rays
};

/// The grid is centred on the box of the mesh, half a pitch or more from its edges. Time grows with
/// triangles, rows crossed and hits. Throws Error (bad_input) if the pitch is not positive or gives
/// too many points.
geometry::PointCloud rays(const model::Mesh& mesh, const RayOptions& options);

}  // namespace lamplock::points
