#include "host/cutting/box_tree.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace lamplock::cutting {

BoxTree::BoxTree(std::vector<Box> boxes) : boxes_(std::move(boxes)), order_(boxes_.size()) {
  std::iota(order_.begin(), order_.end(), std::uint32_t{0});
  if (boxes_.empty()) return;
  nodes_.reserve(2 * (2 * boxes_.size() / leaf_size + 1));
  build(0, static_cast<std::uint32_t>(boxes_.size()));
}

std::uint32_t BoxTree::build(std::uint32_t begin, std::uint32_t end) {
  const auto number = static_cast<std::uint32_t>(nodes_.size());
  Node node;
  node.begin = begin;
  node.end = end;
  for (std::uint32_t i = begin; i < end; ++i) node.box.add(boxes_[order_[i]]);
  nodes_.push_back(node);
  if (end - begin <= leaf_size) return number;
  const Vec side = node.box.high - node.box.low;
  const auto key = [&](std::uint32_t i) {
    const Box& box = boxes_[i];
    return side.x > side.y ? box.low.x + box.high.x : box.low.y + box.high.y;
  };
  const std::uint32_t middle = begin + (end - begin) / 2;
  const auto at = [&](std::uint32_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end),
                   [&](std::uint32_t i, std::uint32_t j) { return key(i) < key(j); });
  const std::uint32_t left = build(begin, middle);
  const std::uint32_t right = build(middle, end);
  nodes_[number].left = left;
  nodes_[number].right = right;
  return number;
}

BoxTree tree_of(const std::vector<Edge>& edges) {
  std::vector<Box> boxes;
  boxes.reserve(edges.size());
  for (const Edge& edge : edges) boxes.push_back(box_of(edge));
  return BoxTree(std::move(boxes));
}

}  // namespace lamplock::cutting
