#include "host/order/clusters.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <tuple>
#include <vector>

#include "host/geometry/bounds.hpp"
#include "host/order/permute.hpp"

namespace lamplock::order {
namespace {

using geometry::Point;
using geometry::PointCloud;
using Index = std::uint32_t;

/// A square that holds points, seen from above.
struct Cell {
  std::int64_t x = 0, y = 0;
  auto operator<=>(const Cell&) const = default;
};

/// Disjoint sets of numbers, each identified by one of them.
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), Index{0});
  }
  Index of(Index i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  /// The lowest number identifies a set.
  void unite(Index i, Index j) {
    i = of(i);
    j = of(j);
    parent_[std::max(i, j)] = std::min(i, j);
  }

 private:
  std::vector<Index> parent_;
};

/// The part of each point: adjacent cells belong to one part.
std::vector<Index> parts_of(std::span<const Point> layer, double cell_mm) {
  const Point low = geometry::bounds(layer).low;
  std::vector<Cell> cell_of;
  cell_of.reserve(layer.size());
  for (const Point& p : layer) {
    cell_of.push_back({std::llround(std::floor((p.x - low.x) / cell_mm)),
                       std::llround(std::floor((p.y - low.y) / cell_mm))});
  }
  std::vector<Cell> cells = cell_of;
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  const auto find = [&](const Cell& cell) {
    return std::lower_bound(cells.begin(), cells.end(), cell) - cells.begin();
  };
  Sets sets(cells.size());
  for (Index i = 0; i < cells.size(); ++i) {
    const Cell& cell = cells[i];
    for (const auto& [x, y] : {std::pair{0, 1}, {1, -1}, {1, 0}, {1, 1}}) {
      const Cell beside{cell.x + x, cell.y + y};
      const auto j = static_cast<std::size_t>(find(beside));
      if (j < cells.size() && cells[j] == beside) sets.unite(i, static_cast<Index>(j));
    }
  }
  std::vector<Index> parts;
  parts.reserve(layer.size());
  for (const Cell& cell : cell_of) parts.push_back(sets.of(static_cast<Index>(find(cell))));
  return parts;
}

/// Sorts a layer by its parts and adds their begins, counted from `first`.
void split(std::span<Point> layer, double cell_mm, std::size_t first, Starts& starts) {
  const std::vector<Index> parts = parts_of(layer, cell_mm);
  Indices order(layer.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](Index i, Index j) { return parts[i] < parts[j]; });
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i == 0 || parts[order[i]] != parts[order[i - 1]]) starts.push_back(first + i);
  }
  permute(layer, std::move(order));
}

}  // namespace

Starts split_into_parts(PointCloud& cloud, const Starts& starts, double apart_mm, double tangent) {
  Starts parts;
  for (std::size_t i = 0; i + 1 < starts.size(); ++i) {
    const std::span<Point> layer = std::span(cloud).subspan(starts[i], starts[i + 1] - starts[i]);
    const geometry::Bounds box = geometry::bounds(layer);
    const double cell_mm = std::max(apart_mm, (box.high.z - box.low.z) * tangent);
    // With cells of size zero only coincident points would share a part: the result is one part.
    constexpr double min_mm = 1e-9;
    if (cell_mm >= min_mm) {
      split(layer, cell_mm, starts[i], parts);
    } else {
      parts.push_back(starts[i]);
    }
  }
  parts.push_back(cloud.size());
  return parts;
}

}  // namespace lamplock::order
