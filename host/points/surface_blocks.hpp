// Cuts a mesh into cubic blocks of space. In: a mesh in mm and the side of a block. Out: the
// triangles with surface in each block, and these pieces of surface. Called by the discretisers
// that work block by block and by the search for the nearest triangle.
//
// A triangle in several blocks is divided by planes between blocks until each part lies in one; a
// part in a plane between two blocks belongs to the upper one. So the pieces of all blocks cover
// the whole surface once. Time and memory grow with triangles and with blocks that have surface,
// not with the space between.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host/geometry/bounds.hpp"
#include "host/geometry/point.hpp"
#include "host/model/mesh.hpp"

namespace lamplock::points {

/// Number of a block along each axis, 0 at the origin.
struct BlockIndex {
  std::int32_t x = 0, y = 0, z = 0;
  friend auto operator<=>(const BlockIndex&, const BlockIndex&) = default;
};

struct BlockGrid {
  geometry::Point origin;
  double side_mm = 1;

  BlockIndex of(const geometry::Point& point) const;
  geometry::Bounds box(const BlockIndex& block) const;
};

/// A grid over `box`. Throws Error (bad_input) if there would be more than 2^20 blocks in a row, or
/// the box reaches further from the origin than 10^7 sides.
BlockGrid grid_over(const geometry::Bounds& box, double side_mm, const std::string& where);

struct SurfaceBlocks {
  BlockGrid grid;
  std::vector<BlockIndex> blocks;  // in order
  /// Those of block i are triangles[first[i]] .. triangles[first[i + 1] - 1].
  std::vector<std::size_t> first;
  std::vector<std::uint32_t> triangles;

  std::span<const std::uint32_t> of(std::size_t block) const {
    return std::span(triangles).subspan(first[block], first[block + 1] - first[block]);
  }
};

/// Triangles without area are left out. The vertices must be finite. Throws Error (bad_input) for
/// too many blocks.
SurfaceBlocks surface_blocks(const model::Mesh& mesh, const BlockGrid& grid,
                             const std::string& where);

using Corners = std::array<geometry::Point, 3>;

/// Adds the part of a triangle inside `box`, cut into triangles, to `pieces`.
void cut_to_box(const Corners& triangle, const geometry::Bounds& box, std::vector<Corners>& pieces);

/// Throws Error (bad_input) that names the first vertex that is not finite or does not exist.
void require_sound(const model::Mesh& mesh, const std::string& where);

Corners corners_of(const model::Mesh& mesh, std::size_t triangle);

/// 0 for a triangle without area.
double area_of(const Corners& triangle);

}  // namespace lamplock::points
