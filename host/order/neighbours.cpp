#include <algorithm>
#include <array>

#include "host/geometry/kd_tree.hpp"
#include "host/order/local_search.hpp"

namespace lamplock::order {
namespace {

constexpr std::size_t max_neighbours = 10;

}  // namespace

Neighbours find_neighbours(std::span<const geometry::Point> points, std::size_t count) {
  Neighbours neighbours;
  neighbours.per_point = std::min({max_neighbours, count, points.empty() ? 0 : points.size() - 1});
  neighbours.list.reserve(points.size() * neighbours.per_point);
  const auto tree = geometry::kd_tree_of(points);
  std::array<std::uint32_t, max_neighbours + 1> index{};
  std::array<double, max_neighbours + 1> squared{};
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const std::size_t found = tree.nearest(points[i], neighbours.per_point + 1, index, squared);
    std::size_t kept = 0;
    for (std::size_t k = 0; k < found && kept < neighbours.per_point; ++k) {
      if (index[k] == i) continue;
      neighbours.list.push_back(index[k]);
      ++kept;
    }
  }
  return neighbours;
}

}  // namespace lamplock::order
