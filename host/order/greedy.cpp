#include "host/order/greedy.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/order/shadow.hpp"

namespace lamplock::order {
namespace {

using geometry::Bounds;
using geometry::Point;

struct Cone {
  Point from;
  ConeWeights weights;
  double height(double dz) const { return (dz > 0 ? weights.up : weights.down) * dz; }
  double cost(const Point& p) const {
    return std::max(std::abs(p.x - from.x), std::abs(p.y - from.y)) + height(p.z - from.z);
  }
  double bound(const Bounds& box) const {
    const double low = box.low.z - from.z, high = box.high.z - from.z;
    double least = std::min(height(low), height(high));
    if (low < 0 && high > 0) least = std::min(least, 0.0);
    return std::max(distance_outside(from.x, box.low.x, box.high.x),
                    distance_outside(from.y, box.low.y, box.high.y)) +
           least;
  }
};

template <class Metric>
std::vector<std::uint32_t> cheapest_first(std::span<const Point> points, Metric metric,
                                          double tangent, const Ordered& ordered) {
  constexpr std::size_t report_interval = 4096;
  RestTree rest(points);
  std::vector<std::uint32_t> fired;
  fired.reserve(points.size());
  std::size_t reported = 0;
  while (!rest.empty()) {
    fire(rest, points, rest.cheapest(metric), tangent, fired);
    metric.from = points[fired.back()];
    if (!ordered || fired.size() - reported < report_interval) continue;
    reported = fired.size();
    ordered(reported);
  }
  return fired;
}

}  // namespace

std::vector<std::uint32_t> nearest_first(std::span<const Point> points, const Point& from,
                                         double tangent, const Ordered& ordered) {
  return cheapest_first(points, Nearest{from}, tangent, ordered);
}

std::vector<std::uint32_t> cone_first(std::span<const Point> points, const Point& from,
                                      const ConeWeights& weights, double tangent,
                                      const Ordered& ordered) {
  return cheapest_first(points, Cone{from, weights}, tangent, ordered);
}

}  // namespace lamplock::order
