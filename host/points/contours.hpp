// Contours of a mesh in planes of constant z. Comes in: a mesh and the planes. Goes out: chained
// polylines, plane by plane. Called by slice(), which says how vertices on a plane are handled.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "host/model/mesh.hpp"
#include "host/points/point.hpp"

namespace lamplock::points {

/// A closed contour does not repeat its first vertex. Vertices may coincide.
struct Contour {
  std::vector<Point> vertices;
  bool closed = false;
};

/// Planes z = first + k * distance for k = 0 .. count - 1.
struct Planes {
  double first = 0, distance = 1;
  std::size_t count = 0;
  double z(std::size_t k) const { return first + static_cast<double>(k) * distance; }
  /// How many planes are at or below `height`: a vertex there is above planes 0 .. result - 1.
  /// Found by comparing with the very planes, so that rounding cannot make two triangles disagree.
  std::size_t not_above(double height) const;
};

/// Calls `visit(k, contours)` for every plane k from below, also for planes that cut nothing.
/// Throws Error (bad_input) if planes and triangles meet too often to be kept in memory.
void for_each_plane(const model::Mesh& mesh, const Planes& planes,
                    const std::function<void(std::size_t, std::span<const Contour>)>& visit);

}  // namespace lamplock::points
