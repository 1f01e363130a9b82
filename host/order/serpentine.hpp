// Serpentine order in strips. In: points of a layer. Out: their order, strip by strip. Called for
// each layer, as an order and as a start for the search for better ones.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/geometry/point.hpp"

namespace lamplock::order {

/// The indices of `layer`. Strips run along the longer side of the layer. Points on a lattice get
/// one strip a row; other points get strips of the width with the shortest path for random points.
std::vector<std::uint32_t> to_and_fro(std::span<const geometry::Point> layer);

}  // namespace lamplock::order
