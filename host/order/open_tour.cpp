#include "host/order/open_tour.hpp"

#include <algorithm>
#include <limits>

namespace lamplock::order {

using geometry::Point;

Cut find_cut(std::span<const Point> tour, std::span<const Point> before, const Point& from,
             const TourCost& cost) {
  const std::size_t n = tour.size();
  const Point last = before.empty() ? from : before.back();
  const Point last_but_one = before.size() < 2 ? last : before[before.size() - 2];
  // Cost of the step to p and the turn to q.
  const auto entry = [&](const Point& p, const Point& q) {
    return cost.turn(last_but_one, last, p) + cost.edge(last, p) + cost.turn(last, p, q);
  };
  Cut best;
  double lowest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < n; ++i) {
    const Point &b = tour[(i + n - 1) % n], &bb = tour[(i + 2 * n - 2) % n];
    const Point &p = tour[i], &pp = tour[(i + 1) % n];
    // Cut between b and p: begin at p forward, or at b backward.
    const double removed = cost.turn(bb, b, p) + cost.edge(b, p) + cost.turn(b, p, pp);
    const double forward_cost = entry(p, pp) - removed, backward_cost = entry(b, bb) - removed;
    if (std::min(forward_cost, backward_cost) >= lowest) continue;
    lowest = std::min(forward_cost, backward_cost);
    best = {i, backward_cost < forward_cost};
  }
  return best;
}

void cut_tour(std::span<Point> tour, std::span<const Point> before, const Point& from,
              const TourCost& cost) {
  cut_open(tour, find_cut(tour, before, from, cost));
}

}  // namespace lamplock::order
