#include <algorithm>
#include <array>
#include <nanoflann.hpp>

#include "host/order/local_search.hpp"

namespace lamplock::order {
namespace {

/// What the k-d tree needs to know about points.
struct Adaptor {
  std::span<const points::Point> points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t index, std::size_t axis) const {
    const points::Point& point = points[index];
    return axis == 0 ? point.x : axis == 1 ? point.y : point.z;
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Adaptor>,
                                                 Adaptor, 3, std::uint32_t>;

constexpr std::size_t most_neighbours = 10;

}  // namespace

Neighbours find_neighbours(std::span<const points::Point> points, std::size_t count) {
  Neighbours neighbours;
  neighbours.per_point = std::min({most_neighbours, count, points.empty() ? 0 : points.size() - 1});
  neighbours.list.reserve(points.size() * neighbours.per_point);
  const Adaptor adaptor{points};
  const Tree tree(3, adaptor, nanoflann::KDTreeSingleIndexAdaptorParams(10));
  std::array<std::uint32_t, most_neighbours + 1> index{};
  std::array<double, most_neighbours + 1> squared{};
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const std::array<double, 3> query{points[i].x, points[i].y, points[i].z};
    const std::size_t found =
        tree.knnSearch(query.data(), neighbours.per_point + 1, index.data(), squared.data());
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
