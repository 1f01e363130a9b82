// Orders that go to the cheapest remaining point, again and again. Comes in: points, where the
// machine stands. Goes out: the points in such an order, which keeps the shadow rule: what the next
// point would shadow is fired just before it. Called for each layer (nearest) or once (cone).
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "host/points/point.hpp"

namespace lamplock::order {

/// Weights of the height in the cone order, per mm: cost of going dz up or down.
struct ConeWeights {
  double up = 0;    // K+
  double down = 0;  // K-; a positive one makes lower points cheaper, so that they come first
};

/// Told now and then how many points have been ordered.
using Ordered = std::function<void(std::size_t)>;

/// Next is the nearest point, from `from` on. The indices of `points` in the order of firing.
std::vector<std::uint32_t> nearest_first(std::span<const points::Point> points,
                                         const points::Point& from, double tangent,
                                         const Ordered& ordered = {});

/// Next is the point with the least max(|dx|, |dy|) + K(dz) dz, where K is K+ above and K- below
/// the machine (SortKdz in "Mechatronic positioning of a pulsed laser beam in devices forming 3-D
/// objects in glass"). With both no less than `tangent` the shadow rule holds without pulling
/// anything ahead: what a point would shadow is then always cheaper than the point.
std::vector<std::uint32_t> cone_first(std::span<const points::Point> points,
                                      const points::Point& from, const ConeWeights& weights,
                                      double tangent, const Ordered& ordered = {});

}  // namespace lamplock::order
