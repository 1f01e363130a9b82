// To and fro in strips. Comes in: points of a layer. Goes out: their order, strip by strip.
// Called for each layer, as an order and as a start for the search for better ones.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/points/point.hpp"

namespace lamplock::order {

/// The indices of `layer`. Strips run along the longer side of the layer. Points on a lattice get
/// one strip a row; others strips as wide as makes the way shortest for random points.
std::vector<std::uint32_t> to_and_fro(std::span<const points::Point> layer);

}  // namespace lamplock::order
