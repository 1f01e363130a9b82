// A tree of rectangles that finds those that meet another one.
//
// In:  rectangles, numbered from 0. Out: the numbers of those that meet a rectangle.
// Who: the checks, the tree and the compensation of contours.
//
// Built at once in n log n by halving at the median of the longer side, so that long thin edges,
// for which a grid has no good size, cost no more than others.
#pragma once

#include <cstddef>
#include <vector>

#include "host/cutting/edge.hpp"

namespace lamplock::cutting {

class BoxTree {
 public:
  explicit BoxTree(std::vector<Box> boxes);

  /// Calls `found(number)` for each rectangle that meets `box`.
  template <class Found>
  void visit(const Box& box, const Found& found) const {
    if (!nodes_.empty()) visit_node(0, box, found);
  }

 private:
  struct Node {
    Box box;
    std::size_t begin = 0, end = 0;   ///< in order_
    std::size_t left = 0, right = 0;  ///< 0: a leaf
  };
  static constexpr std::size_t leaf_size = 8;

  std::size_t build(std::size_t begin, std::size_t end);

  template <class Found>
  void visit_node(std::size_t number, const Box& box, const Found& found) const {
    const Node& node = nodes_[number];
    if (!node.box.meets(box)) return;
    if (node.left != 0) {
      visit_node(node.left, box, found);
      visit_node(node.right, box, found);
      return;
    }
    for (std::size_t i = node.begin; i < node.end; ++i) {
      if (boxes_[order_[i]].meets(box)) found(order_[i]);
    }
  }

  std::vector<Box> boxes_;
  std::vector<std::size_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace lamplock::cutting
