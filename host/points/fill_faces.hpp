// Filling faces ("Mechatronic positioning of a pulsed laser beam in devices forming 3-D objects in
// glass"): each triangle is filled with points at a minimum distance, small triangles are rejected
// and counted, points on shared edges are not doubled. Comes in: a mesh in mm. Goes out: points,
// triangle by triangle. Called by the command line.
//
// A triangle gets rows parallel to its longest side, the first one on it, of points in the closest
// arrangement (equilateral triangles). Neighbours with a common longest side agree about its
// points. All are welded at the distance.
#pragma once

#include <cstddef>

#include "host/model/mesh.hpp"
#include "host/points/point.hpp"

namespace lamplock::points {

struct FaceFillOptions {
  double distance_mm = 0.1;  // no two points are closer
  /// Triangles whose longest side is shorter are rejected; 0: the distance.
  double smallest_side_mm = 0;
};

struct FaceFill {
  PointCloud points;
  std::size_t rejected = 0;  // triangles: too small or without area
  std::size_t welded = 0;    // points too close to one of a triangle before
};

/// Throws Error (bad_input) for options out of range, a vertex that is not finite or too many
/// points.
FaceFill fill_faces(const model::Mesh& mesh, const FaceFillOptions& options);

}  // namespace lamplock::points
