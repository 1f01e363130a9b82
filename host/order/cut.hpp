// Cuts a closed tour open. Comes in: a tour and what was fired before it. Goes out: the tour as an
// open one that begins where that costs least. Called for each layer, one after the other.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "host/order/cost.hpp"
#include "host/points/point.hpp"

namespace lamplock::order {

/// Where a tour begins and which way it is gone.
struct Cut {
  std::size_t first = 0;
  bool backward = false;  // the last point before `first` comes first
};

/// The best cut of a tour. `before` is what was fired so far, the last two points at least; if
/// nothing was, the machine stands at `from`. Time linear.
Cut find_cut(std::span<const points::Point> tour, std::span<const points::Point> before,
             const points::Point& from, const TourCost& cost);

/// Rotates a tour and turns it round, as a cut says.
template <class Thing>
void cut_open(std::span<Thing> tour, const Cut& cut) {
  std::rotate(tour.begin(), tour.begin() + static_cast<std::ptrdiff_t>(cut.first), tour.end());
  if (cut.backward) std::reverse(tour.begin(), tour.end());
}

/// Both at once.
void cut_tour(std::span<points::Point> tour, std::span<const points::Point> before,
              const points::Point& from, const TourCost& cost);

}  // namespace lamplock::order
