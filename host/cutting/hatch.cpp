#include "host/cutting/hatch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <set>
#include <unordered_map>
#include <utility>

#include "host/error.hpp"
#include "host/geometry/limits.hpp"
#include "host/model/curves.hpp"

namespace lamplock::cutting {
namespace {

constexpr const char* hatch_place = "hatch";
// Pieces shorter than this are where a line touches a corner.
constexpr double min_piece_mm = 1e-6;

/// Where a row crosses an edge.
struct Crossing {
  double x;
  std::uint32_t area;  ///< index in Areas
  int turn;            ///< 1 if the edge runs to larger y there, -1 if to smaller y
};

/// The areas of contours, and those that are around the place at which a row is.
class Areas {
 public:
  std::uint32_t index_of(const Contour& contour) {
    const auto next = static_cast<std::uint32_t>(areas_.size());
    const auto [entry, is_new] = indices_.try_emplace(contour.area, next);
    if (is_new) areas_.push_back({contour.area, contour.fill_rule, contour.covers, 0});
    return entry->second;
  }

  void start_row() {
    for (Area& area : areas_) area.turns = 0;
    around_.clear();
    is_odd_ = false;
  }
  void cross(const Crossing& crossing) {
    Area& area = areas_[crossing.area];
    if (area.number == 0) {
      is_odd_ = !is_odd_;
      return;
    }
    const bool was_inside = is_inside(area);
    area.turns += crossing.turn;
    if (is_inside(area) == was_inside) return;
    if (was_inside)
      around_.erase({area.number, area.covers});
    else
      around_.insert({area.number, area.covers});
  }
  bool are_filled() const {
    if (around_.empty()) return is_odd_;
    const auto& [number, covers] = *around_.rbegin();
    return !covers;
  }

 private:
  struct Area {
    std::uint32_t number;  ///< in the order in which areas are painted; 0: contours without one
    model::FillRule rule;
    bool covers;
    int turns;  ///< of its outline around the place
  };
  static bool is_inside(const Area& area) {
    return area.rule == model::FillRule::even_odd ? area.turns % 2 != 0 : area.turns != 0;
  }

  std::unordered_map<std::uint32_t, std::uint32_t> indices_;
  std::vector<Area> areas_;
  std::set<std::pair<std::uint32_t, bool>> around_;  ///< numbers of areas, and if they cover others
  bool is_odd_ = false;                              ///< contours without an area around the place
};

/// Crossings of horizontal lines at the middles of strips with edges, by row.
class Crossings {
 public:
  Crossings(const Box& box, double distance_mm) : low_(box.low.y), distance_(distance_mm) {
    const double rows = std::ceil((box.high.y - box.low.y) / distance_mm);
    if (!(rows <= static_cast<double>(model::max_pieces)))
      throw Error(Exit::bad_input, hatch_place,
                  fmt::format("{:.0f} lines, but at most {} are possible", rows, model::max_pieces),
                  "increase the distance between the lines");
    rows_.resize(static_cast<std::size_t>(std::max(rows, 0.0)));
  }

  /// An arc is divided at its highest and lowest points, so that each part has a row once.
  void add(const Edge& edge, std::uint32_t area) {
    if (edge.is_line()) return add_rising({edge, edge.from, edge.to, area});
    std::vector<double> parts{0, 1};
    for (const double side : {-1.0, 1.0}) {
      const double part = part_at(edge, edge.centre + Vec{0, side * radius_of(edge)});
      if (part > 0 && part < 1) parts.push_back(part);
    }
    std::sort(parts.begin(), parts.end());
    for (std::size_t i = 0; i + 1 < parts.size(); ++i)
      add_rising({edge, point_at(edge, parts[i]), point_at(edge, parts[i + 1]), area,
                  point_at(edge, (parts[i] + parts[i + 1]) / 2).x > edge.centre.x});
  }

  std::vector<std::vector<Crossing>>& rows() { return rows_; }
  std::size_t count() const { return count_; }
  double height(std::size_t row) const {
    return low_ + (static_cast<double>(row) + 0.5) * distance_;
  }

 private:
  /// A part of an edge whose height only grows or only falls.
  struct Part {
    const Edge& edge;
    Vec from, to;
    std::uint32_t area;
    bool is_right = false;  ///< of the centre of an arc
  };

  /// The upper end does not belong to a part, so that two edges that meet on a row are one
  /// crossing, or both or none if they are on one side of it.
  void add_rising(const Part& part) {
    const double low = std::min(part.from.y, part.to.y), high = std::max(part.from.y, part.to.y);
    const double begin = std::max(0.0, std::floor((low - low_) / distance_ - 0.5));
    for (auto row = static_cast<std::size_t>(begin); row < rows_.size(); ++row) {
      const double y = height(row);
      if (y < low) continue;
      if (y >= high) return;
      rows_[row].push_back({x_at(part, y), part.area, part.to.y > part.from.y ? 1 : -1});
      ++count_;
    }
  }

  static double x_at(const Part& part, double y) {
    const auto& [edge, from, to, area, is_right] = part;
    if (edge.is_line()) return from.x + (to.x - from.x) * (y - from.y) / (to.y - from.y);
    const double radius = radius_of(edge), up = y - edge.centre.y;
    const double half = std::sqrt(std::max(0.0, (radius - up) * (radius + up)));
    return edge.centre.x + (is_right ? half : -half);
  }

  double low_, distance_;
  std::vector<std::vector<Crossing>> rows_;
  std::size_t count_ = 0;
};

/// The filled pieces of a row, along X.
HatchRow filled_pieces(std::vector<Crossing>& row, Areas& areas, double y) {
  std::sort(row.begin(), row.end(), [](const Crossing& p, const Crossing& q) { return p.x < q.x; });
  HatchRow pieces;
  areas.start_row();
  bool is_filled = false;
  double begin = 0;
  for (const Crossing& crossing : row) {
    areas.cross(crossing);
    if (areas.are_filled() == is_filled) continue;
    is_filled = !is_filled;
    if (is_filled)
      begin = crossing.x;
    else if (crossing.x - begin >= min_piece_mm)
      pieces.push_back({{begin, y}, {crossing.x, y}});
  }
  return pieces;
}

Edge turned_edge(const Edge& edge, double radians) {
  return {turned(edge.from, radians), turned(edge.to, radians), turned(edge.centre, radians),
          edge.sweep};
}

}  // namespace

std::vector<HatchRow> hatch(const std::vector<Contour>& contours, const HatchOptions& options,
                            std::vector<std::size_t>* missed) {
  geometry::require_positive(options.distance_mm, hatch_place, "distance");
  const double angle = options.angle_deg * std::numbers::pi / 180;
  std::vector<Edge> edges;
  Box box;
  std::vector<std::size_t> first_edges;  // of each contour, and the end of the last one
  for (const Contour& contour : contours) {
    first_edges.push_back(edges.size());
    if (!contour.closed) continue;
    for (const Edge& edge : contour.edges) {
      edges.push_back(turned_edge(edge, -angle));
      box.add(box_of(edges.back()));
    }
  }
  std::vector<HatchRow> result;
  if (edges.empty()) return result;
  first_edges.push_back(edges.size());
  Areas areas;
  Crossings crossings(box, options.distance_mm);
  for (std::size_t i = 0; i < contours.size(); ++i) {
    const std::size_t before = crossings.count();
    const std::uint32_t area = areas.index_of(contours[i]);
    for (std::size_t k = first_edges[i]; k < first_edges[i + 1]; ++k) crossings.add(edges[k], area);
    if (missed != nullptr && contours[i].closed && crossings.count() == before)
      missed->push_back(i);
  }
  for (std::size_t i = 0; i < crossings.rows().size(); ++i) {
    HatchRow pieces = filled_pieces(crossings.rows()[i], areas, crossings.height(i));
    if (pieces.empty()) continue;
    for (HatchPiece& piece : pieces) piece = {turned(piece.from, angle), turned(piece.to, angle)};
    result.push_back(std::move(pieces));
  }
  return result;
}

}  // namespace lamplock::cutting
