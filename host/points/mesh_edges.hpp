// The edges of a mesh, numbered. In: triangles. Out: a number for every undirected edge. Called by
// slice() to chain cuts of neighbouring triangles.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/model/mesh.hpp"

namespace lamplock::points {

struct MeshEdges {
  std::size_t count = 0;
  /// Per triangle the numbers of edges 0-1, 1-2, 2-0.
  std::vector<std::array<std::uint32_t, 3>> of_triangle;
};

/// Linear in the number of triangles (hashed).
MeshEdges number_edges(const model::Mesh& mesh);

}  // namespace lamplock::points
