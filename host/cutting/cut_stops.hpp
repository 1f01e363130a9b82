// Contours as the search for an order sees them: points where cutting begins and ends.
//
// In:  start points and parents of contours. Out: sequences of them, their rapid way.
// Who: cut_order() and its stages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "host/cutting/edge.hpp"

namespace lamplock::cutting {

struct CutStop {
  /// Start points; of an open contour its two ends, or its begin alone if it has a direction.
  std::vector<Vec> starts;
  bool open = false;
  std::optional<Vec> end{};   ///< of an open contour that has a direction, and of an engraved area
  std::size_t parent = none;  ///< has to be cut after this one
  std::size_t children = 0;   ///< contours that have to be cut before
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

  const Vec& entry(std::size_t start) const { return starts[start]; }
  const Vec& exit(std::size_t start) const { return end ? *end : starts[open ? 1 - start : start]; }
};

/// A contour of the order with the number of its start point.
struct CutVisit {
  std::size_t stop = 0, start = 0;
};

double rapid_way(const std::vector<CutStop>& stops, const std::vector<CutVisit>& visits,
                 const Vec& position);

/// Always the nearest stop whose children are cut.
std::vector<CutVisit> nearest_visits(const std::vector<CutStop>& stops, const Vec& position);

/// The best order of at most max_exact stops.
std::vector<CutVisit> exact_visits(const std::vector<CutStop>& stops, const Vec& position);

/// The order after all improvements by other start points, 2-opt and Or-opt that keep children
/// before their parents; open contours without a direction may be turned. At least one visit.
std::vector<CutVisit> improved_visits(const std::vector<CutStop>& stops,
                                      const std::vector<CutVisit>& visits, const Vec& position);

/// The best order that a genetic algorithm finds from random orders and this one, never longer than
/// this one. The number of orders in a generation is at least 2.
std::vector<CutVisit> genetic_visits(const std::vector<CutStop>& stops,
                                     const std::vector<CutVisit>& visits, std::size_t population,
                                     const Vec& position);

/// The best start points for this order.
void choose_starts(const std::vector<CutStop>& stops, std::vector<CutVisit>& visits,
                   const Vec& position);

}  // namespace lamplock::cutting
