// Filling faces ("Mechatronic positioning of a pulsed laser beam in devices forming 3-D objects in
// glass"): faces are filled with points at a minimum distance, points on shared edges are not
// doubled. In: a mesh in mm. Out: points, patch by patch. Called by the command line.
//
// Neighbouring triangles that are nearly in one plane form a patch (face_patches.hpp). A patch gets
// rows of points parallel to the longest side of its largest triangle, the first one on it, in the
// densest arrangement (equilateral triangles), in its plane; the points are then put on the
// triangles. So a face has the same density whether it is one triangle or a thousand that are
// smaller than the distance. All points are welded at the distance.
#pragma once

#include <cstddef>

#include "host/geometry/point.hpp"
#include "host/model/mesh.hpp"

namespace lamplock::points {

struct FaceFillOptions {
  double distance_mm = 0.1;  // no two points are closer
  /// Triangles whose longest side is shorter are rejected; 0: none.
  double min_side_mm = 0;
};

struct FaceFill {
  geometry::PointCloud points;
  std::size_t rejected = 0;  // triangles: too small or without area
  std::size_t welded = 0;    // points too close to an earlier one
};

/// Throws Error (bad_input) for options out of range, a vertex that is not finite or too many
/// points.
FaceFill fill_faces(const model::Mesh& mesh, const FaceFillOptions& options);

}  // namespace lamplock::points
