// beam_faults(): beams of contours that are too near to each other.
#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "host/cutting/beams.hpp"
#include "host/geometry/parallel.hpp"

namespace lamplock::cutting {
namespace {

/// The drawn contours overlap, too, which the faults of the drawing report.
bool is_drawn_overlap(const Fault& fault, const std::vector<Shape>& shapes) {
  if (fault.kind != FaultKind::overlap || !fault.contour || !fault.other) return false;
  const std::vector<Fault> drawn =
      contour_faults({shapes[*fault.contour].contour, shapes[*fault.other].contour});
  return std::any_of(drawn.begin(), drawn.end(),
                     [](const Fault& one) { return one.kind == FaultKind::overlap; });
}

/// Paths of the beam that cross although the drawing does not: parts that are too near.
std::vector<Fault> crossings_of(const Beams& beams, const std::vector<Shape>& shapes) {
  std::vector<Fault> faults = contour_faults(beams.contours);
  for (Fault& fault : faults) {
    if (fault.kind == FaultKind::crossing) fault.kind = FaultKind::beams;
    if (fault.contour) fault.contour = beams.shapes[*fault.contour];
    if (fault.other) fault.other = beams.shapes[*fault.other];
  }
  std::erase_if(faults, [&](const Fault& fault) { return is_drawn_overlap(fault, shapes); });
  return faults;
}

}  // namespace

/// Beams that cut into another contour without crossing its beam are found too: where a gap is
/// narrower than the beam, those of a hole and of the island in it change their places.
std::vector<Fault> beam_faults(const Beams& beams, const DrawnContours& drawn,
                               const std::vector<Shape>& shapes,
                               const std::vector<Operation>& operations) {
  std::vector<Fault> faults = crossings_of(beams, shapes);
  std::set<std::pair<std::size_t, std::size_t>> known;
  for (const Fault& fault : faults)
    if (fault.contour && fault.other) known.insert(std::minmax(*fault.contour, *fault.other));
  std::vector<std::vector<DrawnContours::Cut>> found(beams.contours.size());
  geometry::for_each_index(found.size(), 0, [&](std::size_t i) {
    if (!beams.is_moved[i]) return;
    const std::size_t shape = beams.shapes[i];
    found[i] =
        drawn.cut_by(beams.contours[i], shape, operations[*shapes[shape].operation].kerf_mm / 2);
  });
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (const DrawnContours::Cut& cut : found[i]) {
      const std::size_t shape = beams.shapes[i];
      if (!known.insert(std::minmax(shape, cut.contour)).second) continue;
      double gap_mm = std::numeric_limits<double>::infinity();
      for (const Edge& edge : shapes[shape].contour.edges)
        gap_mm = std::min(gap_mm, distance_to(edge, cut.at));
      faults.push_back({FaultKind::near, cut.at, gap_mm, shape, cut.contour});
    }
  }
  return faults;
}

}  // namespace lamplock::cutting
