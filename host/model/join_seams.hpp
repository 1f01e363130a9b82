// Joins the two sides of seams whose coordinates differ in their last digits, as programs write
// them that compute a vertex twice (sin(2 pi) is -2e-16).
//
// In:  a mesh whose equal corners are merged. Out: the same mesh, closed where only rounding had
//      opened it.
// Who: MeshBuilder::take(); fill_solid() asks for the size of a gap.
#pragma once

#include <cstdint>
#include <vector>

#include "host/model/mesh.hpp"

namespace lamplock::model {

/// Vertices of open edges that are closer than a few steps of single precision at the size of the
/// mesh become one. Other vertices, and so all details of a closed mesh, are not touched. Triangles
/// that lose an edge are dropped; `kept` has a number for each triangle and loses theirs. Returns
/// the number of vertices that were joined.
std::size_t join_seams(Mesh& mesh, std::vector<std::uint32_t>& kept);

/// The greatest distance from a vertex of open edges to the nearest other one, mm: the width of the
/// widest gap, or for a missing triangle about the length of its side. 0 without open edges.
double widest_gap_mm(const Mesh& mesh);

}  // namespace lamplock::model
