#include "host/cutting/box_tree.hpp"

#include <numeric>
#include <utility>

namespace lamplock::cutting {
namespace {

// Few boxes stay in their order: edges of a contour follow each other anyway.
constexpr std::size_t max_unsorted = 64;
constexpr int curve_bits = 16;  // of each coordinate on the curve

/// Place on Hilbert's curve, which visits all cells of a square so that those that follow each
/// other are neighbours (H. S. Warren, "Hacker's Delight", 2nd edition, 2012, chapter 16).
std::uint32_t place_on_curve(std::uint32_t x, std::uint32_t y) {
  std::uint32_t place = 0;
  constexpr std::uint32_t all = (1u << curve_bits) - 1;
  for (std::uint32_t side = 1u << (curve_bits - 1); side > 0; side /= 2) {
    const bool is_right = (x & side) != 0, is_upper = (y & side) != 0;
    place = place * 4 + (is_right ? (is_upper ? 2u : 3u) : (is_upper ? 1u : 0u));
    if (is_upper) continue;
    if (is_right) {
      x = all - x;
      y = all - y;
    }
    std::swap(x, y);
  }
  return place;
}

}  // namespace

BoxTree::BoxTree(const std::vector<Box>& boxes) : order_(boxes.size()), places_(boxes.size()) {
  std::iota(order_.begin(), order_.end(), std::uint32_t{0});
  if (boxes.size() > max_unsorted) sort(boxes);
  for (std::size_t i = 0; i < order_.size(); ++i)
    places_[order_[i]] = static_cast<std::uint32_t>(i);
  build(boxes);
}

void BoxTree::sort(const std::vector<Box>& boxes) {
  Box all;
  const auto middle = [](const Box& box) { return (box.low + box.high) * 0.5; };
  for (const Box& box : boxes) all.add(middle(box));
  const double side = std::max(all.high.x - all.low.x, all.high.y - all.low.y);
  const double cells_per_mm = side > 0 ? ((1u << curve_bits) - 1) / side : 0;
  std::vector<std::uint64_t> keys(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const Vec at = (middle(boxes[i]) - all.low) * cells_per_mm;
    const std::uint32_t place =
        place_on_curve(static_cast<std::uint32_t>(at.x), static_cast<std::uint32_t>(at.y));
    keys[i] = std::uint64_t{place} << 32 | i;
  }
  std::sort(keys.begin(), keys.end());
  for (std::size_t i = 0; i < keys.size(); ++i) order_[i] = static_cast<std::uint32_t>(keys[i]);
}

void BoxTree::build(const std::vector<Box>& boxes) {
  std::size_t size = 0;
  for (std::size_t count = boxes.size(); count > 1; count = (count + fan - 1) / fan) size += count;
  nodes_.reserve(size + 1);
  for (const std::uint32_t i : order_) nodes_.push_back(boxes[i]);
  levels_.push_back({0, nodes_.size()});
  while (levels_.back().count > 1) {
    const Level below = levels_.back();
    levels_.push_back({nodes_.size(), (below.count + fan - 1) / fan});
    for (std::size_t i = 0; i < below.count; i += fan) {
      Box box;
      for (std::size_t k = i; k < std::min(i + fan, below.count); ++k)
        box.add(nodes_[below.first + k]);
      nodes_.push_back(box);
    }
  }
}

BoxTree tree_of(const std::vector<Edge>& edges) {
  std::vector<Box> boxes;
  boxes.reserve(edges.size());
  for (const Edge& edge : edges) boxes.push_back(box_of(edge));
  return BoxTree(boxes);
}

}  // namespace lamplock::cutting
