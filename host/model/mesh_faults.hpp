// Faults of a mesh that can nevertheless be read. In: a mesh. Out: counts, the first fault of each
// kind by index and coordinates, and lines of warning. Called by the command line after the reader,
// and by fill_solid(), which needs a closed body.
//
// Linear but for one sort of the edges.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/model/mesh.hpp"

namespace lamplock::model {

/// Faults of one kind: their count, and the place of the first one (in the order of triangles).
struct MeshFault {
  std::size_t count = 0;
  std::size_t triangle = 0;  // index from 0
  geometry::Point from, to;  // the edge; for a vertex or a triangle `from` alone
};

struct MeshFaults {
  MeshFault open_edges;           // used by one triangle only: the surface has a hole
  MeshFault non_manifold_edges;   // used by more than two
  MeshFault turned_edges;         // used by two triangles of opposite orientation
  MeshFault flat_triangles;       // without area
  MeshFault not_finite_vertices;  // `triangle` is the index of the vertex
  MeshFault missing_vertices;     // triangles that name a vertex which does not exist
  /// Closed and consistently oriented, but normals point inwards (its signed volume is negative).
  bool inside_out = false;

  bool none() const;
  /// No edge is used an odd number of times: rays cross the surface an even number of times.
  bool closed = false;
};

/// Never throws for a broken mesh.
MeshFaults find_faults(const Mesh& mesh);

/// One line for each kind of fault: its count, the place of the first one, its meaning.
std::vector<std::string> warnings(const MeshFaults& faults);

}  // namespace lamplock::model
