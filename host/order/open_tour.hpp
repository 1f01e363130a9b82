// Cuts a closed tour open. In: a tour and the points fired before it. Out: an open tour with the
// begin of least cost. Called for each layer, one after the other.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "host/geometry/point.hpp"
#include "host/order/cost.hpp"

namespace lamplock::order {

/// Begin and direction of a tour.
struct Cut {
  std::size_t first = 0;
  bool backward = false;  // the last point before `first` comes first
};

/// The best cut of a tour. `before` has the points fired so far, at least the last two; if it is
/// empty, the machine is at `from`. Time linear.
Cut find_cut(std::span<const geometry::Point> tour, std::span<const geometry::Point> before,
             const geometry::Point& from, const TourCost& cost);

/// Rotates, and maybe reverses, a tour by a cut.
template <class Thing>
void cut_open(std::span<Thing> tour, const Cut& cut) {
  std::rotate(tour.begin(), tour.begin() + static_cast<std::ptrdiff_t>(cut.first), tour.end());
  if (cut.backward) std::reverse(tour.begin(), tour.end());
}

/// Finds and makes the best cut.
void cut_tour(std::span<geometry::Point> tour, std::span<const geometry::Point> before,
              const geometry::Point& from, const TourCost& cost);

}  // namespace lamplock::order
