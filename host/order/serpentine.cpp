#include "host/order/serpentine.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "host/geometry/bounds.hpp"

namespace lamplock::order {
namespace {

using geometry::Point;
using Coordinate = double Point::*;

/// A point and the strip it lies in.
struct Placed {
  double strip = 0, along = 0;
  std::uint32_t index = 0;
};

std::size_t distinct(std::span<const Point> layer, Coordinate coordinate) {
  std::vector<double> values;
  values.reserve(layer.size());
  for (const Point& p : layer) values.push_back(p.*coordinate);
  std::sort(values.begin(), values.end());
  return static_cast<std::size_t>(std::unique(values.begin(), values.end()) - values.begin());
}

/// True if rows of equal `across` have several points each.
bool has_rows(std::span<const Point> layer, Coordinate across) {
  constexpr std::size_t fewest_in_a_row = 4;
  return layer.size() >= fewest_in_a_row * distinct(layer, across);
}

}  // namespace

std::vector<std::uint32_t> to_and_fro(std::span<const Point> layer) {
  const geometry::Bounds box = geometry::bounds(layer);
  const double width = box.high.x - box.low.x, depth = box.high.y - box.low.y;
  const bool along_x = width >= depth;
  const Coordinate along = along_x ? &Point::x : &Point::y,
                   across = along_x ? &Point::y : &Point::x;
  const bool rows = has_rows(layer, across);
  // A step through random points goes w / 3 across a strip of width w and area / (n w) along it:
  // the sum is least for w = sqrt(3 area / n).
  const double strip_mm = std::sqrt(3 * width * depth / static_cast<double>(layer.size()));
  std::vector<Placed> placed;
  placed.reserve(layer.size());
  for (std::uint32_t i = 0; i < layer.size(); ++i) {
    const double off = layer[i].*across - box.low.*across;
    placed.push_back(
        {rows || strip_mm <= 0 ? off : std::floor(off / strip_mm), layer[i].*along, i});
  }
  std::stable_sort(placed.begin(), placed.end(), [](const Placed& p, const Placed& q) {
    return std::tie(p.strip, p.along) < std::tie(q.strip, q.along);
  });
  bool back = false;
  for (auto strip = placed.begin(); strip != placed.end(); back = !back) {
    const auto end =
        std::find_if(strip, placed.end(), [&](const Placed& p) { return p.strip != strip->strip; });
    if (back) std::reverse(strip, end);
    strip = end;
  }
  std::vector<std::uint32_t> order;
  order.reserve(placed.size());
  for (const Placed& p : placed) order.push_back(p.index);
  return order;
}

}  // namespace lamplock::order
