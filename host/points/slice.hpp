// Slicing ("Mechatronic positioning of a pulsed laser beam in devices forming 3-D objects in
// glass"): parallel planes cut the mesh, each contour becomes points at equal arc length. Comes in:
// a mesh in mm. Goes out: points, plane by plane from below, contour by contour along each. Called
// by the command line; weld() follows, because neighbouring contours may touch.
//
// A vertex on a plane counts as above it. So each triangle is cut in exactly two edges or not at
// all, neighbours agree about their common edge, and the contours of a closed mesh are closed. A
// flat bottom that lies in a plane gives no contour, a flat top gives its rim.
#pragma once

#include <optional>

#include "host/model/mesh.hpp"
#include "host/points/point.hpp"

namespace lamplock::points {

struct SliceOptions {
  double layer_mm = 0.1;   // from plane to plane
  double vertex_mm = 0.1;  // wanted distance along the contour
  /// z of the first plane and the highest z a plane may have; without them half a layer above the
  /// lowest vertex up to the highest.
  std::optional<double> first_mm{}, last_mm{};
  /// Layer k starts its contours k times this further along, so that points of layers need not
  /// stand above each other (phase of twist).
  double twist_mm = 0;
  /// Open contours (the mesh has a hole) also get a point at each end; otherwise the outermost
  /// points are half a distance from the ends.
  bool end_points = false;
};

/// A closed contour of length L gets n = max(1, floor(L / vertex_mm)) points at distance L / n
/// along it, counted counter-clockwise (seen from +z) from its point of largest x. Time and memory
/// grow with triangles, cuts and points. Throws Error (bad_input) for options that are not positive
/// or would give too many points.
PointCloud slice(const model::Mesh& mesh, const SliceOptions& options);

}  // namespace lamplock::points
