// Cuts a closed tour open. Comes in: a tour and what was fired before it. Goes out: the tour as an
// open one that begins where that costs least. Called for each layer, one after the other.
#pragma once

#include <span>

#include "host/order/cost.hpp"
#include "host/points/point.hpp"

namespace lamplock::order {

/// `before` is what was fired so far; if nothing was, the machine stands at `from`. The tour is
/// rotated and maybe turned round. Time linear.
void cut_tour(std::span<points::Point> tour, std::span<const points::Point> before,
              const points::Point& from, const TourCost& cost);

}  // namespace lamplock::order
