#include "host/cutting/engraving.hpp"

#include <algorithm>
#include <utility>

#include "host/cutting/box_tree.hpp"
#include "host/cutting/cut_stops.hpp"
#include "host/cutting/hatch.hpp"
#include "host/geometry/union_find.hpp"

namespace lamplock::cutting {
namespace {

/// Contours that are filled together: their boxes are not farther apart than a gap that is
/// crossed at the feed. The next area is the nearest one. Covers alone are no area.
std::vector<std::vector<std::size_t>> areas_of(const std::vector<Contour>& contours,
                                               double max_gap_mm, const Vec& position) {
  std::vector<Box> boxes;
  boxes.reserve(contours.size());
  for (const Contour& contour : contours) boxes.push_back(box_of(contour));
  geometry::UnionFind joined(contours.size());
  const BoxTree tree(boxes);
  for (std::size_t i = 0; i < boxes.size(); ++i)
    tree.visit(boxes[i].grown(max_gap_mm), [&](std::size_t j) { joined.join(i, j); });
  std::vector<std::vector<std::size_t>> areas = joined.sets();
  std::erase_if(areas, [&](const std::vector<std::size_t>& area) {
    return std::all_of(area.begin(), area.end(), [&](std::size_t i) { return contours[i].covers; });
  });
  std::vector<CutStop> stops;
  stops.reserve(areas.size());
  for (const std::vector<std::size_t>& area : areas) {
    CutStop& stop = stops.emplace_back();
    stop.starts.reserve(area.size());
    for (const std::size_t i : area) stop.starts.push_back(boxes[i].low);
    stop.end = boxes[area.front()].high;
  }
  std::vector<std::vector<std::size_t>> ordered;
  ordered.reserve(areas.size());
  for (const CutVisit& visit : nearest_visits(stops, position))
    ordered.push_back(std::move(areas[visit.stop]));
  return ordered;
}

Stroke stroke_of(const HatchRow& row, double overscan_mm) {
  Stroke stroke;
  const Vec first = row.front().from, last = row.back().to;
  const Vec way = last - first, unit = way * (1 / norm(way));
  const auto add = [&stroke](const Vec& from, const Vec& to, CutKind kind, double power) {
    stroke.push_back({{from, to, {}, 0}, kind, power});
  };
  if (overscan_mm > 0) add(first - unit * overscan_mm, first, CutKind::lead_in, 0);
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (i > 0) add(row[i - 1].to, row[i].from, CutKind::cut, 0);
    add(row[i].from, row[i].to, CutKind::cut, 1);
  }
  if (overscan_mm > 0) add(last, last + unit * overscan_mm, CutKind::lead_out, 0);
  return stroke;
}

/// The contours that decide what is filled, with their numbers: those with a fill and all covers,
/// or without any fill all as lines.
std::vector<Contour> painted_contours(const std::vector<Contour>& contours,
                                      const std::vector<Contour>& covers,
                                      std::vector<std::size_t>& numbers) {
  const bool has_fill = std::any_of(contours.begin(), contours.end(), [](const Contour& contour) {
    return contour.area != 0 && !contour.covers;
  });
  std::vector<Contour> painted;
  painted.reserve(contours.size() + covers.size());
  for (std::size_t i = 0; i < contours.size(); ++i) {
    if (has_fill && contours[i].area == 0) continue;
    painted.push_back(contours[i]);
    numbers.push_back(i);
    if (has_fill) continue;
    painted.back().area = 0;
    painted.back().covers = false;
  }
  if (has_fill) painted.insert(painted.end(), covers.begin(), covers.end());
  return painted;
}

/// Every second row runs back. Rows are divided at gaps that rapids cross.
void append_rows(std::vector<HatchRow> rows, const Operation& operation,
                 std::vector<Stroke>& strokes) {
  bool is_back = false;
  for (HatchRow& row : rows) {
    if (std::exchange(is_back, !is_back)) {
      std::reverse(row.begin(), row.end());
      for (HatchPiece& piece : row) std::swap(piece.from, piece.to);
    }
    HatchRow part;
    for (const HatchPiece& piece : row) {
      if (!part.empty() && distance(part.back().to, piece.from) > operation.max_gap_mm) {
        strokes.push_back(stroke_of(part, operation.overscan_mm));
        part.clear();
      }
      part.push_back(piece);
    }
    strokes.push_back(stroke_of(part, operation.overscan_mm));
  }
}

}  // namespace

Engraving engrave_areas(const std::vector<Contour>& contours, const std::vector<Contour>& covers,
                        const Operation& operation, const Vec& position) {
  Engraving engraving;
  std::vector<std::size_t> numbers;
  const std::vector<Contour> painted = painted_contours(contours, covers, numbers);
  for (std::size_t i = 0; i < contours.size(); ++i)
    if (!std::binary_search(numbers.begin(), numbers.end(), i)) engraving.unfilled.push_back(i);
  for (const std::vector<std::size_t>& area : areas_of(painted, operation.max_gap_mm, position)) {
    std::vector<Contour> filled;
    filled.reserve(area.size());
    for (const std::size_t i : area) filled.push_back(painted[i]);
    std::vector<std::size_t> missed;
    append_rows(hatch(filled, {operation.hatch_mm, operation.hatch_deg}, &missed), operation,
                engraving.strokes);
    for (const std::size_t i : missed)
      if (!filled[i].covers) engraving.missed.push_back(numbers[area[i]]);
  }
  return engraving;
}

}  // namespace lamplock::cutting
