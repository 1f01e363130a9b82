// A tree of rectangles that finds those that meet another one.
//
// In:  rectangles, numbered from 0. Out: the numbers of those that meet a rectangle.
// Who: the checks, the tree and the compensation of contours.
//
// Built at once in n log n by halving at the median of the longer side, so that long thin edges,
// for which a grid has no good size, cost no more than others.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/cutting/edge.hpp"

namespace lamplock::cutting {

class BoxTree {
 public:
  explicit BoxTree(std::vector<Box> boxes);

  /// True if test(number) is true for a rectangle that meets `box`; ends at the first.
  template <class Test>
  bool any(const Box& box, const Test& test) const {
    return !nodes_.empty() && any_in_node(
                                  0, [&](const Box& one) { return one.meets(box); }, test);
  }

  /// True if test(number) is true for a rectangle within a distance of a point.
  template <class Test>
  bool any_near(const Vec& at, double reach_mm, const Test& test) const {
    const double square = reach_mm * reach_mm;
    return !nodes_.empty() &&
           any_in_node(
               0, [&](const Box& one) { return square_to(one, at) <= square; }, test);
  }

  /// Calls `found(number)` for each rectangle that meets `box`.
  template <class Found>
  void visit(const Box& box, const Found& found) const {
    any(box, [&](std::size_t number) {
      found(number);
      return false;
    });
  }

  const Box& box(std::size_t number) const { return boxes_[number]; }

 private:
  struct Node {
    Box box;
    std::uint32_t begin = 0, end = 0;   ///< in order_
    std::uint32_t left = 0, right = 0;  ///< 0: a leaf
  };
  static constexpr std::uint32_t leaf_size = 8;

  std::uint32_t build(std::uint32_t begin, std::uint32_t end);

  static double square_to(const Box& box, const Vec& at) {
    const double x = std::max({box.low.x - at.x, at.x - box.high.x, 0.0});
    const double y = std::max({box.low.y - at.y, at.y - box.high.y, 0.0});
    return x * x + y * y;
  }

  template <class Meets, class Test>
  bool any_in_node(std::uint32_t number, const Meets& meets, const Test& test) const {
    const Node& node = nodes_[number];
    if (!meets(node.box)) return false;
    if (node.left != 0)
      return any_in_node(node.left, meets, test) || any_in_node(node.right, meets, test);
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
      const std::size_t found = order_[i];
      if (meets(boxes_[found]) && test(found)) return true;
    }
    return false;
  }

  std::vector<Box> boxes_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

/// A tree of the boxes of edges, with their numbers.
BoxTree tree_of(const std::vector<Edge>& edges);

}  // namespace lamplock::cutting
