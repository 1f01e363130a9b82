// A short and even tour through the points of one layer. Comes in: the points of the layer. Goes
// out: their order round a closed tour. Called for each layer, from several threads.
//
// Two tours are tried: round a closed space-filling curve (E. H. Moore, "On certain crinkly
// curves", 1900) and, if the points lie on a lattice as those of bitmaps do, row by row to and fro.
// Both are improved by local search, the cheaper one is taken.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/points/point.hpp"

namespace lamplock::order {

/// The indices of `layer` in the order of a closed tour. It may be cut anywhere and gone either
/// way; the tour of a lattice has one long edge that is meant to be cut.
std::vector<std::uint32_t> closed_tour(std::span<const points::Point> layer);

}  // namespace lamplock::order
