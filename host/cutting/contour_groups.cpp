#include "host/cutting/contour_groups.hpp"

#include <optional>
#include <utility>

#include "host/cutting/box_tree.hpp"
#include "host/geometry/union_find.hpp"

namespace lamplock::cutting {
namespace {

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
  geometry::UnionFind group(contours.size());
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
  return group.sets();
}

}  // namespace lamplock::cutting
