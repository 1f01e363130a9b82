// A tour through the points of one layer. Comes in: the points of the layer. Goes out: their order
// round a closed tour. Called for each layer, from several threads.
//
// Tours are tried from several starts: round a closed space-filling curve (E. H. Moore, "On certain
// crinkly curves", 1900); row by row to and fro, if the points lie on a lattice as those of bitmaps
// do; for few beats also to the nearest point and in strips. All are improved by local search, the
// cheapest is taken.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/order/beat_model.hpp"
#include "host/points/point.hpp"

namespace lamplock::order {

/// The indices of `layer` in the order of a short and even closed tour. It may be cut anywhere and
/// gone either way; the tour of a lattice has one long edge that is meant to be cut.
std::vector<std::uint32_t> even_tour(std::span<const points::Point> layer);

/// The same for as few beats as can be found by asking the model about so many exchanges a point.
std::vector<std::uint32_t> beat_tour(std::span<const points::Point> layer, const BeatModel& model,
                                     std::size_t asked_a_point);

}  // namespace lamplock::order
