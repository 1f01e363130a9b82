// Parts of a mesh: triangles connected by edges. In: triangles. Out: the number of the part of
// each, and whether the orientations in a part agree. Called by bodies_of()
// and fill_solid().
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "host/points/vertical_crossings.hpp"

namespace lamplock::points {

/// One use of an edge by a triangle.
struct EdgeUse {
  std::uint32_t low = 0, high = 0, triangle = 0;
  bool forward = false;  ///< from low to high
};

/// All uses, those of one edge together.
std::vector<EdgeUse> sorted_edge_uses(std::span<const Triangle> triangles);

/// Calls `visit(uses)` for the uses of each edge.
template <class Visit>
void for_each_edge(std::span<const EdgeUse> uses, const Visit& visit) {
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    while (end < uses.size() && uses[end].low == uses[begin].low &&
           uses[end].high == uses[begin].high) {
      ++end;
    }
    visit(uses.subspan(begin, end - begin));
  }
}

struct MeshParts {
  std::vector<std::uint32_t> of_triangle;
  std::size_t count = 0;
};

/// Triangles at an edge of two are one part. Sets of triangles that use an edge of more an odd
/// number of times belong together. Triangles with the same three vertices are in one part and
/// count once.
MeshParts parts_of(const std::vector<Triangle>& triangles);

/// The triangles without those that name the same three vertices as an earlier one.
std::vector<Triangle> without_duplicates(const std::vector<Triangle>& triangles);

/// Turns triangles so that both at an edge of two pass it in opposite directions; in each part the
/// first triangle stays.
void orient_alike(std::vector<Triangle>& triangles);

}  // namespace lamplock::points
