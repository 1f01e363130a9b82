// A triangle mesh in the units of its file: what the mesh readers give and what the discretisers
// take.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "host/points/point.hpp"

namespace lamplock::model {

/// Corners of equal position are one vertex; no triangle names a vertex twice.
struct Mesh {
  std::vector<points::Point> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

}  // namespace lamplock::model
