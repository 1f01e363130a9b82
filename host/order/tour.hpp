// A tour through the points of one layer. In: the points of the layer. Out: their order along a
// closed tour. Called for each layer, from several threads.
//
// Tours begin from several starts: along a closed space-filling curve (E. H. Moore, "On certain
// crinkly curves", 1900); row by row to and fro, if the points are on a lattice like those of
// bitmaps; for few beats also nearest first and in strips. All are improved by local search, and
// the cheapest is used.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/geometry/point.hpp"
#include "host/order/beat_model.hpp"

namespace lamplock::order {

/// The indices of `layer` in the order of a short and even closed tour. It may be cut anywhere and
/// reversed; the tour of a lattice has one long edge that should be cut.
std::vector<std::uint32_t> even_tour(std::span<const geometry::Point> layer);

/// The same for few beats, with `asked_a_point` exchanges per point evaluated by the model.
std::vector<std::uint32_t> beat_tour(std::span<const geometry::Point> layer, const BeatModel& model,
                                     std::size_t asked_a_point);

}  // namespace lamplock::order
