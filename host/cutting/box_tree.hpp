// A tree of rectangles that finds those that meet another one.
//
// In:  rectangles, numbered from 0. Out: the numbers of those that meet a rectangle.
// Who: the checks, the tree and the compensation of contours.
//
// Built at once in n log n: rectangles are sorted along Hilbert's curve, each 8 that follow each
// other get one around them, each 8 of these again, and so on (packed R-tree; I. Kamel and C.
// Faloutsos, "On packing R-trees", CIKM 1993). Long thin edges, for which a grid has no good size,
// cost no more than others.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/cutting/edge.hpp"

namespace lamplock::cutting {

class BoxTree {
 public:
  explicit BoxTree(const std::vector<Box>& boxes);

  /// True if test(number) is true for a rectangle that meets `box`; ends at the first.
  template <class Test>
  bool any(const Box& box, const Test& test) const {
    return any_of(
        levels_.size() - 1, 0, [&](const Box& one) { return one.meets(box); }, test);
  }

  /// True if test(number) is true for a rectangle within a distance of a point.
  template <class Test>
  bool any_near(const Vec& at, double reach_mm, const Test& test) const {
    const double square = reach_mm * reach_mm;
    return any_of(
        levels_.size() - 1, 0, [&](const Box& one) { return square_to(one, at) <= square; }, test);
  }

  /// Calls `found(number)` for each rectangle that meets `box`.
  template <class Found>
  void visit(const Box& box, const Found& found) const {
    any(box, [&](std::size_t number) {
      found(number);
      return false;
    });
  }

  const Box& box(std::size_t number) const { return nodes_[places_[number]]; }
  /// Around all rectangles.
  Box extent() const { return nodes_.empty() ? Box{} : nodes_.back(); }
  std::size_t size() const { return order_.size(); }

 private:
  static constexpr std::size_t fan = 8;

  /// Boxes of one level in nodes_; each but those of the lowest is around `fan` of the level below.
  struct Level {
    std::size_t first, count;
  };

  void sort(const std::vector<Box>& boxes);
  void build(const std::vector<Box>& boxes);

  static double square_to(const Box& box, const Vec& at) {
    const double x = std::max({box.low.x - at.x, at.x - box.high.x, 0.0});
    const double y = std::max({box.low.y - at.y, at.y - box.high.y, 0.0});
    return x * x + y * y;
  }

  /// The boxes from `begin` on, `fan` at most, of a level.
  template <class Meets, class Test>
  bool any_of(std::size_t level, std::size_t begin, const Meets& meets, const Test& test) const {
    const Level& boxes = levels_[level];
    const std::size_t end = std::min(begin + fan, boxes.count);
    for (std::size_t i = begin; i < end; ++i) {
      if (!meets(nodes_[boxes.first + i])) continue;
      if (level > 0 ? any_of(level - 1, i * fan, meets, test) : test(std::size_t{order_[i]}))
        return true;
    }
    return false;
  }

  std::vector<std::uint32_t> order_;   ///< numbers of the boxes in the lowest level
  std::vector<std::uint32_t> places_;  ///< there, by their numbers
  std::vector<Box> nodes_;             ///< all levels, the lowest one first
  std::vector<Level> levels_;
};

/// A tree of the boxes of edges, with their numbers.
BoxTree tree_of(const std::vector<Edge>& edges);

}  // namespace lamplock::cutting
