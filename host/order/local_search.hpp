// Improves a tour by small exchanges (2-opt and Or-opt between near points: J. L. Bentley, "Fast
// algorithms for geometric traveling salesman problems", ORSA Journal on Computing, 1992), with the
// cost of cost.hpp. In: points, their neighbours, a tour. Out: a tour that costs no more. Called
// for each layer. The time of an exchange is bounded, so the total is near-linear.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "host/geometry/point.hpp"
#include "host/order/cost.hpp"

namespace lamplock::order {

/// `per_point` nearest other points of each point, nearest first, one point after the other.
struct Neighbours {
  std::size_t per_point = 0;
  std::vector<std::uint32_t> list;
  std::span<const std::uint32_t> of(std::uint32_t point) const {
    return std::span(list).subspan(point * per_point, per_point);
  }
};

// Lists of 5 to 8 are usual for short tours, where more gained under 0.5 %.
inline constexpr std::size_t short_way_neighbours = 7;
// An even motion may continue at a point that is not among the nearest: 10 instead of 7 save up to
// 2 % of the beats where they are scarce.
inline constexpr std::size_t few_beats_neighbours = 10;

/// At most `count` (up to 10) neighbours of each point. `points` should all differ, and points with
/// neighbouring numbers should be near each other (memory access).
Neighbours find_neighbours(std::span<const geometry::Point> points, std::size_t count);

enum class Closing {
  closed,  // the edge from the last point to the first costs like any other
  open     // it costs nothing
};

/// `tour` has every index of `points` once, before and after.
void improve(std::span<const geometry::Point> points, const Neighbours& neighbours, Closing closing,
             const TourCost& cost, std::vector<std::uint32_t>& tour);

/// The same by the model of the planner, where it finds wasted beats: several times slower, for a
/// tour that is good already. Afterwards the tour may cost more by `TourCost`. `max_asked` bounds
/// the time: the maximum number of evaluations of the model, about 4 us each.
void save_beats(std::span<const geometry::Point> points, const Neighbours& neighbours,
                Closing closing, const BeatModel& model, std::size_t max_asked,
                std::vector<std::uint32_t>& tour);

}  // namespace lamplock::order
