#include "host/order/shadow.hpp"

#include <algorithm>

#include "host/order/permute.hpp"

namespace lamplock::order {

using geometry::Point;

std::optional<Shadowed> first_shadowed(std::span<const Point> order, double half_angle_deg) {
  require_coordinates(order);
  return find_shadowed(order, cone_tangent(half_angle_deg));
}

std::optional<Shadowed> find_shadowed(std::span<const Point> order, double tangent) {
  RestTree later(order);
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    later.remove(i);
    if (const auto shadowed = later.under_cone(order[i], tangent)) return Shadowed{i, *shadowed};
  }
  return std::nullopt;
}

void fire(RestTree& rest, std::span<const Point> points, std::uint32_t point, double tangent,
          std::vector<std::uint32_t>& fired) {
  std::vector<std::uint32_t> waiting{point};  // each under the cone of the one before
  while (!waiting.empty()) {
    if (const auto lower = rest.under_cone(points[waiting.back()], tangent)) {
      waiting.push_back(*lower);
      continue;
    }
    rest.remove(waiting.back());
    fired.push_back(waiting.back());
    waiting.pop_back();
  }
}

void pull_ahead(std::span<Point> order, double tangent) {
  const auto [lowest, highest] = std::minmax_element(
      order.begin(), order.end(), [](const Point& p, const Point& q) { return p.z < q.z; });
  if (order.empty() || lowest->z == highest->z) return;
  RestTree rest(order);
  Indices fired;
  fired.reserve(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    if (rest.holds(i)) fire(rest, order, i, tangent, fired);
  }
  permute(order, std::move(fired));
}

}  // namespace lamplock::order
