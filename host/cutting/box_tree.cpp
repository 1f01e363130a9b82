#include "host/cutting/box_tree.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace lamplock::cutting {

BoxTree::BoxTree(std::vector<Box> boxes) : boxes_(std::move(boxes)), order_(boxes_.size()) {
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  if (!boxes_.empty()) build(0, boxes_.size());
}

std::size_t BoxTree::build(std::size_t begin, std::size_t end) {
  const std::size_t number = nodes_.size();
  Node node;
  node.begin = begin;
  node.end = end;
  for (std::size_t i = begin; i < end; ++i) node.box.add(boxes_[order_[i]]);
  nodes_.push_back(node);
  if (end - begin <= leaf_size) return number;
  const Vec side = node.box.high - node.box.low;
  const auto key = [&](std::size_t i) {
    const Box& box = boxes_[i];
    return side.x > side.y ? box.low.x + box.high.x : box.low.y + box.high.y;
  };
  const std::size_t middle = begin + (end - begin) / 2;
  const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end),
                   [&](std::size_t i, std::size_t j) { return key(i) < key(j); });
  const std::size_t left = build(begin, middle);
  const std::size_t right = build(middle, end);
  nodes_[number].left = left;
  nodes_[number].right = right;
  return number;
}

}  // namespace lamplock::cutting
