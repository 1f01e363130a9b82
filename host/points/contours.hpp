// Contours of a mesh in planes of constant z. In: a mesh and the planes. Out: chained polylines,
// plane by plane. Called by slice(), whose header explains vertices on a plane.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "host/geometry/point.hpp"
#include "host/model/mesh.hpp"

namespace lamplock::points {

/// A closed contour does not repeat its first vertex. Vertices may coincide.
struct Contour {
  std::vector<geometry::Point> vertices;
  bool closed = false;
};

/// Planes z = first + k * distance for k = 0 .. count - 1.
struct Planes {
  double first = 0, distance = 1;
  std::size_t count = 0;
  double z(std::size_t k) const { return first + static_cast<double>(k) * distance; }
  /// Number of planes at or below `height`: a vertex there is above planes 0 .. result - 1.
  /// Compares with the planes themselves, so that rounding cannot make two triangles disagree.
  std::size_t not_above(double height) const;
};

/// Calls `visit(k, contours)` for every plane k from below, also for planes without cuts. Throws
/// Error (bad_input) if there are too many cuts for the memory.
void for_each_plane(const model::Mesh& mesh, const Planes& planes,
                    const std::function<void(std::size_t, std::span<const Contour>)>& visit);

}  // namespace lamplock::points
