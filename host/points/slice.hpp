// Slicing ("Mechatronic positioning of a pulsed laser beam in devices forming 3-D objects in
// glass"): parallel planes cut the mesh, each contour becomes points at equal arc length. Comes in:
// a mesh in mm. Goes out: points, plane by plane along the axis, contour by contour along each, and
// on request what got lost. Called by the command line; weld() follows, because neighbouring
// contours may touch.
//
// A vertex on a plane counts as above it. So each triangle is cut in exactly two edges or not at
// all, neighbours agree about their common edge, and the contours of a closed mesh are closed. A
// flat bottom that lies in a plane gives no contour, a flat top gives its rim.
#pragma once

#include <cstddef>
#include <optional>

#include "host/model/mesh.hpp"
#include "host/points/axis.hpp"
#include "host/points/point.hpp"

namespace lamplock::points {

/// Which way the planes face. The frame of slicing has the axis as its third axis (x: y z x, y: z x
/// y, z: x y z) and is then turned about the fixed axes x, y and z, in this order. The turn about
/// the axis itself says where contours start.
struct SliceFrame {
  Axis axis = Axis::z;
  double turn_x_deg = 0, turn_y_deg = 0, turn_z_deg = 0;
};

struct SliceOptions {
  double layer_mm = 0.1;   // from plane to plane
  double vertex_mm = 0.1;  // wanted distance along the contour
  /// Place of the first plane along the axis and the furthest place a plane may have; without them
  /// half a layer behind the lowest vertex up to the highest.
  std::optional<double> first_mm{}, last_mm{};
  /// The same counted from the mesh: the first plane this far behind its lowest vertex, none closer
  /// than this before its highest. Not together with first_mm, last_mm.
  std::optional<double> first_offset_mm{}, last_offset_mm{};
  /// Layer k starts its contours k times this further along, so that points of layers need not
  /// stand above each other (phase of twist).
  double twist_mm = 0;
  /// Open contours (the mesh has a hole) also get a point at each end; otherwise the outermost
  /// points are half a distance from the ends.
  bool end_points = false;
  SliceFrame frame{};
};

/// A closed contour of length L gets n = max(1, floor(L / vertex_mm)) points at distance L / n
/// along it, counted counter-clockwise (seen against the axis) from its point of largest first
/// coordinate in the frame. Time and memory grow with triangles, cuts and points. Throws Error
/// (bad_input) for options that are not positive, not finite, contradict each other or would give
/// too many points.
PointCloud slice(const model::Mesh& mesh, const SliceOptions& options);

/// Faces that slicing does not show: nearly parallel to the planes and cut by none.
struct LostFaces {
  std::size_t triangles = 0;
  double area_mm2 = 0;
  double share = 0;  ///< of the area of the mesh, 0..1
};

/// On a face tilted so little, contours are more than ten times as far apart as planes: asin(1/10).
inline constexpr double flat_face_deg = 5.739;

/// What slice() with these options loses: a cylinder its caps. `within_deg` is the largest angle
/// between a lost face's normal and the axis. The poles of a sphere count too, to half a per cent
/// of its area; a warning is due where more is lost. Throws as slice(), and for an angle that is
/// not in 0..90.
LostFaces lost_faces(const model::Mesh& mesh, const SliceOptions& options,
                     double within_deg = flat_face_deg);

}  // namespace lamplock::points
