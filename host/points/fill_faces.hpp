// Filling faces ("Mechatronic positioning of a pulsed laser beam in devices forming 3-D objects in
// glass"): each triangle is filled with points at a minimum distance, small triangles are rejected
// and counted, points on shared edges are not doubled. In: a mesh in mm. Out: points, triangle by
// triangle. Called by the command line.
//
// A triangle gets rows of points parallel to its longest side, the first one on it, in the densest
// arrangement (equilateral triangles). Neighbours with a common longest side have the same points
// on it. All points are welded at the distance.
#pragma once

#include <cstddef>

#include "host/geometry/point.hpp"
#include "host/model/mesh.hpp"

namespace lamplock::points {

struct FaceFillOptions {
  double distance_mm = 0.1;  // no two points are closer
  /// Triangles whose longest side is shorter are rejected; 0: the distance.
  double smallest_side_mm = 0;
};

struct FaceFill {
  geometry::PointCloud points;
  std::size_t rejected = 0;  // triangles: too small or without area
  std::size_t welded = 0;    // points too close to one of an earlier triangle
};

/// Throws Error (bad_input) for options out of range, a vertex that is not finite or too many
/// points.
FaceFill fill_faces(const model::Mesh& mesh, const FaceFillOptions& options);

}  // namespace lamplock::points
