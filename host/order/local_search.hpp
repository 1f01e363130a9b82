// Improves a tour by small exchanges (2-opt and Or-opt between near points: J. L. Bentley, "Fast
// algorithms for geometric traveling salesman problems", ORSA Journal on Computing, 1992), with the
// cost of cost.hpp. Comes in: points, their neighbours, a tour. Goes out: a tour that costs no
// more. Called for each layer. Every exchange is bounded, so the time is near-linear.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "host/order/cost.hpp"
#include "host/points/point.hpp"

namespace lamplock::order {

/// `per_point` nearest other points of each point, nearest first, one point after the other.
struct Neighbours {
  std::size_t per_point = 0;
  std::vector<std::uint32_t> list;
  std::span<const std::uint32_t> of(std::uint32_t point) const {
    return std::span(list).subspan(point * per_point, per_point);
  }
};

// Lists of 5 to 8 are usual for a short way, where more gained under 0.5 %.
inline constexpr std::size_t short_way_neighbours = 7;
// What goes on evenly need not be near: 10 instead of 7 save up to 2 % of the beats where they are
// scarce.
inline constexpr std::size_t few_beats_neighbours = 10;

/// At most `count` (up to 10) of each. `points` should all differ and neighbouring numbers should
/// lie near each other (memory).
Neighbours find_neighbours(std::span<const points::Point> points, std::size_t count);

enum class Closing {
  closed,  // the way from the last point back to the first costs like any other
  open     // it is free
};

/// `tour` holds every index of `points` once and stays such a permutation.
void improve(std::span<const points::Point> points, const Neighbours& neighbours, Closing closing,
             const TourCost& cost, std::vector<std::uint32_t>& tour);

/// The same judged by the model of the planner, where it finds wasted beats: several times slower,
/// for a tour that is good already. It may cost more by `TourCost` afterwards.
/// `most_asked` bounds the time: the model is asked so often at most, about 4 us each.
void save_beats(std::span<const points::Point> points, const Neighbours& neighbours,
                Closing closing, const BeatModel& model, std::size_t most_asked,
                std::vector<std::uint32_t>& tour);

}  // namespace lamplock::order
