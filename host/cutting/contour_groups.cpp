#include "host/cutting/contour_groups.hpp"

#include <numeric>
#include <optional>
#include <utility>

#include "host/cutting/box_tree.hpp"

namespace lamplock::cutting {
namespace {

/// Joins groups of numbers (Tarjan, "Efficiency of a good but not linear set union algorithm",
/// Journal of the ACM 22, 1975; halved paths, the lowest number represents a group).
class UnionFind {
 public:
  explicit UnionFind(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  std::size_t find(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t i, std::size_t j) {
    i = find(i);
    j = find(j);
    parent_[std::max(i, j)] = std::min(i, j);
  }

 private:
  std::vector<std::size_t> parent_;
};

std::vector<Box> boxes_of(const std::vector<Contour>& contours) {
  std::vector<Box> boxes;
  boxes.reserve(contours.size());
  for (const Contour& contour : contours) boxes.push_back(box_of(contour));
  return boxes;
}

}  // namespace

std::vector<std::vector<std::size_t>> contour_groups(const std::vector<Contour>& contours,
                                                     double reach_mm) {
  const BoxTree tree(boxes_of(contours));
  UnionFind group(contours.size());
  std::vector<std::optional<BoxTree>> edges(contours.size());
  const auto half_of = [&](std::size_t i) {
    return tree.box(i).high.x - tree.box(i).low.x + tree.box(i).high.y - tree.box(i).low.y;
  };
  for (std::size_t i = 0; i < contours.size(); ++i) {
    tree.visit(tree.box(i).grown(reach_mm), [&](std::size_t j) {
      if (j <= i || group.find(i) == group.find(j)) return;
      // A hole is inside of the box of its part, but far from its edges.
      const auto [large, small] = half_of(i) > half_of(j) ? std::pair(i, j) : std::pair(j, i);
      if (!edges[large]) edges[large] = tree_of(contours[large].edges);
      if (edges[large]->any(tree.box(small).grown(reach_mm), [](std::size_t) { return true; }))
        group.join(i, j);
    });
  }
  std::vector<std::vector<std::size_t>> groups;
  std::vector<std::size_t> place(contours.size());
  for (std::size_t i = 0; i < contours.size(); ++i) {
    const std::size_t first = group.find(i);
    if (first == i) {
      place[i] = groups.size();
      groups.emplace_back();
    }
    groups[place[first]].push_back(i);
  }
  return groups;
}

}  // namespace lamplock::cutting
