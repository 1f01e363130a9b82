// Greedy orders: the next point is the cheapest remaining one. In: points, the position of the
// machine. Out: the points in such an order, which keeps the shadow rule: points that the next
// point would shadow are fired just before it. Called for each layer (nearest) or once (cone).
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "host/geometry/point.hpp"

namespace lamplock::order {

/// Weights of the height in the cone order, per mm: cost of dz up or down.
struct ConeWeights {
  double up = 0;    // K+
  double down = 0;  // K-; a positive one makes lower points cheaper, so that they come first
};

/// Called now and then with the number of points ordered.
using Ordered = std::function<void(std::size_t)>;

/// The next point is the nearest, beginning at `from`. The indices of `points` in firing order.
std::vector<std::uint32_t> nearest_first(std::span<const geometry::Point> points,
                                         const geometry::Point& from, double tangent,
                                         const Ordered& ordered = {});

/// The next point is that with the least max(|dx|, |dy|) + K(dz) dz, where K is K+ above and K-
/// below the machine (SortKdz in "Mechatronic positioning of a pulsed laser beam in devices forming
/// 3-D objects in glass"). If both are at least `tangent` the order keeps the shadow rule by
/// itself: points that a point would shadow are always cheaper than this point.
std::vector<std::uint32_t> cone_first(std::span<const geometry::Point> points,
                                      const geometry::Point& from, const ConeWeights& weights,
                                      double tangent, const Ordered& ordered = {});

}  // namespace lamplock::order
