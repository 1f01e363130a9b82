#include "host/cutting/duplicate_filter.hpp"

#include <algorithm>

#include "host/cutting/box_tree.hpp"
#include "host/cutting/place_grid.hpp"

namespace lamplock::cutting {
namespace {

// Contours further apart than this are cut by two beams beside each other: the width of the beam of
// a focused laser.
constexpr double max_duplicate_mm = 0.1;
// Contours shorter than so many times their distance are neighbours, not duplicates.
constexpr double min_lengths = 8;

bool have_same_ends(const Contour& a, const Contour& b, double near_mm) {
  const Vec &from = a.edges.front().from, &to = a.edges.back().to;
  const Vec &begin = b.edges.front().from, &end = b.edges.back().to;
  return std::min(std::max(distance(from, begin), distance(to, end)),
                  std::max(distance(from, end), distance(to, begin))) <= near_mm;
}

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
  std::vector<Size> sizes;
  sizes.reserve(contours.size());
  double max_near = 0;
  for (const Contour& contour : contours) {
    const double length = length_of(contour);
    sizes.push_back(
        {box_of(contour), std::min({tolerance_, max_duplicate_mm, length / min_lengths})});
    max_near = std::max(max_near, sizes.back().near_mm);
  }
  std::vector<std::size_t> kept;
  kept.reserve(contours.size());
  if (contours.empty()) return kept;
  PlaceGrid grid(2 * (1 + part_of_corner) * max_near, contours.size());
  for (std::size_t i = 0; i < contours.size(); ++i) {
    const Contour& contour = contours[i];
    const Vec at = key(sizes[i].box);
    if (grid.any(at, [&](std::size_t other) {
          return is_same(contour, sizes[i], contours[other], sizes[other]);
        })) {
      faults_.push_back({FaultKind::duplicate, contour.edges.front().from, length_of(contour), {}});
      continue;
    }
    grid.add(at, i);
    kept.push_back(i);
  }
  return kept;
}

bool DuplicateFilter::is_same(const Contour& a, const Size& size_a, const Contour& b,
                              const Size& size_b) const {
  const double near_mm = std::min(size_a.near_mm, size_b.near_mm);
  return group(a) == group(b) && a.closed == b.closed &&
         distance(size_a.box.low, size_b.box.low) <= near_mm * 2 &&
         distance(size_a.box.high, size_b.box.high) <= near_mm * 2 &&
         (a.closed || have_same_ends(a, b, near_mm)) && is_covered(a, b, near_mm) &&
         is_covered(b, a, near_mm);
}

}  // namespace lamplock::cutting
