// Slicing ("Mechatronic positioning of a pulsed laser beam in devices forming 3-D objects in
// glass"): parallel planes cut the mesh, each contour becomes points at equal arc length. In: a
// mesh in mm. Out: points, plane by plane along the axis, contour by contour along each.
// Called by the command line; weld() of each layer follows, because contours
// of a plane may touch.
//
// A vertex on a plane counts as above it, but those of a place that is the lowest in its
// surroundings as below. So each triangle is cut in exactly two edges or none, neighbours agree
// about their common edge, and the contours of a closed mesh are closed. A flat top and a flat
// bottom in a plane give their rims.
#pragma once

#include <optional>

#include "host/geometry/axis.hpp"
#include "host/geometry/point.hpp"
#include "host/model/mesh.hpp"
#include "host/points/layered_points.hpp"

namespace lamplock::points {

/// Orientation of the planes. The frame of slicing has the axis as its third axis (x: y z x, y: z x
/// y, z: x y z) and is then turned about the fixed axes x, y and z, in this order. The turn about
/// the axis itself determines the start of contours.
struct SliceFrame {
  geometry::Axis axis = geometry::Axis::z;
  double turn_x_deg = 0, turn_y_deg = 0, turn_z_deg = 0;
};

struct SliceOptions {
  double layer_mm = 0.1;   // from plane to plane
  double vertex_mm = 0.1;  // wanted distance along the contour
  /// Position of the first plane along the axis and maximum position of a plane; default: half a
  /// layer after the lowest vertex, and the highest vertex.
  std::optional<double> first_mm{}, last_mm{};
  /// The same relative to the mesh: distance of the first plane from its lowest vertex, minimum
  /// distance of planes from its highest one. Not together with first_mm, last_mm.
  std::optional<double> first_offset_mm{}, last_offset_mm{};
  /// In layer k the first point of a contour is shifted along it by k times this, so that points of
  /// layers need not be above each other (phase of twist).
  double twist_mm = 0;
  /// Open contours (the mesh has a hole) also get a point at each end; otherwise the outermost
  /// points are half a distance from the ends.
  bool end_points = false;
  SliceFrame frame{};
};

/// A closed contour of length L gets n = max(1, floor(L / vertex_mm)) points at distance L / n
/// along it, counted counter-clockwise (seen against the axis) from its point of largest first
/// coordinate in the frame. Time and memory grow with triangles, cuts and points. Throws Error
/// (bad_input) for options that are not positive, not finite, inconsistent or would give too many
/// points.
geometry::PointCloud slice(const model::Mesh& mesh, const SliceOptions& options);

/// The same with the planes that have points as layers.
LayeredPoints slice_in_layers(const model::Mesh& mesh, const SliceOptions& options);

/// The extent of a mesh across the planes, mm.
double height_across(const model::Mesh& mesh, const SliceFrame& frame);

}  // namespace lamplock::points
