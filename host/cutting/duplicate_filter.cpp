#include "host/cutting/duplicate_filter.hpp"

#include <algorithm>

#include "host/cutting/box_tree.hpp"
#include "host/cutting/place_grid.hpp"

namespace lamplock::cutting {
namespace {

bool is_covered(const Contour& contour, const Contour& by, double tolerance_mm) {
  const BoxTree tree = tree_of(by.edges);
  return std::all_of(contour.edges.begin(), contour.edges.end(), [&](const Edge& edge) {
    for (const double part : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      const Vec point = point_at(edge, part);
      const bool is_near = tree.any_near(point, tolerance_mm, [&](std::size_t i) {
        return distance_to(by.edges[i], point) <= tolerance_mm;
      });
      if (!is_near) return false;
    }
    return true;
  });
}

}  // namespace

std::vector<std::size_t> DuplicateFilter::keep(const std::vector<Contour>& contours) {
  // Both corners in one place: of many lines from one point, or rings about it, each has another.
  const auto key = [](const Box& box) {
    return box.low + Vec{box.high.y, box.high.x} * part_of_corner;
  };
  PlaceGrid grid(2 * (1 + part_of_corner) * tolerance_, contours.size());
  std::vector<std::size_t> kept;
  kept.reserve(contours.size());
  std::vector<Box> boxes;
  boxes.reserve(contours.size());
  for (std::size_t i = 0; i < contours.size(); ++i) {
    const Contour& contour = contours[i];
    boxes.push_back(box_of(contour));
    const Vec at = key(boxes[i]);
    if (grid.any(at, [&](std::size_t other) {
          return is_same(contour, boxes[i], contours[other], boxes[other]);
        })) {
      faults_.push_back({FaultKind::duplicate, contour.edges.front().from, length_of(contour), {}});
      continue;
    }
    grid.add(at, i);
    kept.push_back(i);
  }
  return kept;
}

bool DuplicateFilter::is_same(const Contour& a, const Box& box_a, const Contour& b,
                              const Box& box_b) const {
  return group(a) == group(b) && a.closed == b.closed &&
         distance(box_a.low, box_b.low) <= tolerance_ * 2 &&
         distance(box_a.high, box_b.high) <= tolerance_ * 2 && is_covered(a, b, tolerance_) &&
         is_covered(b, a, tolerance_);
}

}  // namespace lamplock::cutting
