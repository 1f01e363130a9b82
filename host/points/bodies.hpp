// The bodies of a mesh with all normals outwards, so that the winding number decides what is
// inside. In: a closed mesh, oriented in any way. Out: its triangles. Called by Inside and
// fill_solid().
//
// Triangles that share edges form a part; parts that share only a closed line of edges are apart.
//   * A part has a winding number if each edge is used equally often in both directions. Otherwise,
//     or if every triangle is there in both orientations, equal triangles are reduced to one and
//     neighbours are oriented alike. Where that fails, only the parity of crossings is left.
//   * A part whose normals point inwards (its volume is negative) is turned, unless it is a cavity:
//     it lies wholly in another part. Parts wholly in a turned part are turned with it, so a model
//     that is inside out keeps its cavities.
#pragma once

#include <vector>

#include "host/model/mesh.hpp"
#include "host/points/vertical_crossings.hpp"

namespace lamplock::points {

struct Bodies {
  std::vector<Triangle> oriented;  ///< inside: the winding number is not zero
  std::vector<Triangle> others;    ///< inside: a ray crosses them an odd number of times
  double volume_mm3 = 0;           ///< of all bodies, overlaps counted as often as they are there
};

/// Vertices must be finite. Time grows with triangles, and with those above the vertices of nested
/// parts if a part has its normals inwards.
Bodies bodies_of(const model::Mesh& mesh);

}  // namespace lamplock::points
