// A mesh cut into cubic blocks of space. Comes in: a mesh in mm and the side of a block. Goes out:
// which triangles have surface in which block, and those pieces of surface. Called by the
// discretisers that work block by block and by the search for the nearest triangle.
//
// A triangle that lies in several blocks is halved by planes between blocks until each part lies in
// one; a part in a plane between two blocks belongs to the upper one. So the pieces of all blocks
// are the whole surface, once. Time and memory grow with triangles and with blocks that have
// surface, not with the space between.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host/model/mesh.hpp"
#include "host/points/bounds.hpp"
#include "host/points/point.hpp"

namespace lamplock::points {

/// Number of a block along each axis, 0 at the origin.
struct BlockIndex {
  std::int32_t x = 0, y = 0, z = 0;
  friend auto operator<=>(const BlockIndex&, const BlockIndex&) = default;
};

struct BlockGrid {
  Point origin;
  double side_mm = 1;

  BlockIndex of(const Point& point) const;
  Bounds box(const BlockIndex& block) const;
};

/// A grid over `box`. Throws Error (bad_input) if there would be more than 2^20 blocks in a row.
BlockGrid grid_over(const Bounds& box, double side_mm, const std::string& where);

struct SurfaceBlocks {
  BlockGrid grid;
  std::vector<BlockIndex> blocks;  // in order
  /// Those of block i are triangles[first[i]] up to before triangles[first[i + 1]].
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

using Corners = std::array<Point, 3>;

/// Adds the part of a triangle inside `box`, cut into triangles, to `pieces`.
void cut_to_box(const Corners& triangle, const Bounds& box, std::vector<Corners>& pieces);

/// Throws Error (bad_input) that names the first vertex which is not finite or does not exist.
void require_sound(const model::Mesh& mesh, const std::string& where);

Corners corners_of(const model::Mesh& mesh, std::size_t triangle);

/// 0 for a triangle without area.
double area_of(const Corners& triangle);

}  // namespace lamplock::points
