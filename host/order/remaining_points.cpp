#include "host/order/remaining_points.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "host/error.hpp"
#include "host/order/cone.hpp"

namespace lamplock::order {
namespace {

using geometry::Bounds;
using geometry::Point;

constexpr unsigned code_bits = 21;  // per coordinate: three of them fill 64 bits

/// Two zero bits before each bit of the lowest 21.
std::uint64_t spread(std::uint64_t bits) {
  bits = (bits | bits << 32) & 0x001f00000000ffffu;
  bits = (bits | bits << 16) & 0x001f0000ff0000ffu;
  bits = (bits | bits << 8) & 0x100f00f00f00f00fu;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3u;
  return (bits | bits << 2) & 0x1249249249249249u;
}

/// The nearest float below or above a number, so that a box of floats contains its points.
float below(double value) {
  const auto single = static_cast<float>(value);
  return single <= value ? single : std::nextafter(single, -std::numeric_limits<float>::max());
}
float above(double value) {
  const auto single = static_cast<float>(value);
  return single >= value ? single : std::nextafter(single, std::numeric_limits<float>::max());
}

/// Places along the curve with the index of the point, sorted.
std::vector<std::pair<std::uint64_t, std::uint32_t>> places_along_curve(
    std::span<const Point> points) {
  const Bounds box = geometry::bounds(points);
  const double side = box.max_side();
  const double scale = side > 0 ? ((1u << code_bits) - 1) / side : 0;
  const auto cell = [&](double value, double low) {
    return spread(static_cast<std::uint64_t>((value - low) * scale));
  };
  std::vector<std::pair<std::uint64_t, std::uint32_t>> places(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Point& p = points[i];
    places[i] = {cell(p.x, box.low.x) | cell(p.y, box.low.y) << 1 | cell(p.z, box.low.z) << 2, i};
  }
  std::sort(places.begin(), places.end());
  return places;
}

/// True if a point of the box may lie under the cone.
bool may_be_under(const Point& apex, const Bounds& box, double tangent) {
  const double x = std::max({box.low.x - apex.x, apex.x - box.high.x, 0.0});
  const double y = std::max({box.low.y - apex.y, apex.y - box.high.y, 0.0});
  return is_under(apex.z - box.low.z, x, y, tangent);
}

}  // namespace

void require_coordinates(std::span<const Point> points) {
  constexpr double max_mm = 1e6;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point& p = points[i];
    // Written so that NaN fails.
    if (std::abs(p.x) <= max_mm && std::abs(p.y) <= max_mm && std::abs(p.z) <= max_mm) continue;
    throw Error(
        Exit::bad_input, "order",
        fmt::format("point {} has a coordinate that is not finite or too large: ({}, {}, {}) mm", i,
                    p.x, p.y, p.z),
        "correct the point list: coordinates in mm, at most 1000000 mm from zero");
  }
}

RestTree::RestTree(std::span<const Point> points) {
  const auto places = places_along_curve(points);
  points_.reserve(points.size());
  index_.reserve(points.size());
  slot_.resize(points.size());
  for (const auto& [place, i] : places) {
    slot_[i] = static_cast<Index>(index_.size());
    index_.push_back(i);
    points_.push_back(points[i]);
  }
  present_.assign(points.size(), 1);
  leaves_ = std::max<std::size_t>(1, (points.size() + leaf_points - 1) / leaf_points);
  nodes_.resize(2 * leaves_);
  for (std::size_t i = 0; i < leaves_; ++i) nodes_[leaves_ + i] = leaf(i);
  for (std::size_t i = leaves_ - 1; i > 0; --i) nodes_[i] = join(nodes_[2 * i], nodes_[2 * i + 1]);
}

RestTree::Node RestTree::leaf(std::size_t number) const {
  Node node;
  const std::size_t first = number * leaf_points;
  const std::size_t last = std::min(first + leaf_points, points_.size());
  for (std::size_t slot = first; slot < last; ++slot) {
    if (!present_[slot]) continue;
    const Point& p = points_[slot];
    node = join(
        node,
        {{below(p.x), below(p.y), below(p.z)}, {above(p.x), above(p.y), above(p.z)}, index_[slot]});
  }
  return node;
}

RestTree::Node RestTree::join(const Node& a, const Node& b) {
  if (a.least == none) return b;
  if (b.least == none) return a;
  Node both{a.low, a.high, std::min(a.least, b.least)};
  for (std::size_t axis = 0; axis < both.low.size(); ++axis) {
    both.low[axis] = std::min(a.low[axis], b.low[axis]);
    both.high[axis] = std::max(a.high[axis], b.high[axis]);
  }
  return both;
}

void RestTree::set_present(Index point, bool present) {
  const std::size_t slot = slot_[point];
  present_[slot] = present ? 1 : 0;
  std::size_t node = slot / leaf_points;
  nodes_[leaves_ + node] = leaf(node);
  for (node = (leaves_ + node) / 2; node > 0; node /= 2) {
    nodes_[node] = join(nodes_[2 * node], nodes_[2 * node + 1]);
  }
}

std::optional<RestTree::Index> RestTree::under_cone(const Point& apex, double tangent) const {
  std::array<std::size_t, 2 * 64> waiting{};  // twice the depth is enough
  std::size_t count = 0;
  waiting[count++] = 1;
  while (count > 0) {
    const std::size_t node = waiting[--count];
    if (nodes_[node].least == none || !may_be_under(apex, nodes_[node].box(), tangent)) continue;
    if (node < leaves_) {
      waiting[count++] = 2 * node;
      waiting[count++] = 2 * node + 1;
      continue;
    }
    const std::size_t first = (node - leaves_) * leaf_points;
    const std::size_t last = std::min(first + leaf_points, points_.size());
    for (std::size_t slot = first; slot < last; ++slot) {
      if (present_[slot] && shadows(apex, points_[slot], tangent)) return index_[slot];
    }
  }
  return std::nullopt;
}

}  // namespace lamplock::order
