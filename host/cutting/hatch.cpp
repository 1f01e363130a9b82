#include "host/cutting/hatch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "host/error.hpp"
#include "host/geometry/limits.hpp"
#include "host/model/curves.hpp"

namespace lamplock::cutting {
namespace {

constexpr const char* hatch_place = "hatch";
// Pieces shorter than this are where a line touches a corner.
constexpr double min_piece_mm = 1e-6;

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
  void add(const Edge& edge) {
    if (edge.is_line()) return add_rising({edge, edge.from, edge.to});
    std::vector<double> parts{0, 1};
    for (const double side : {-1.0, 1.0}) {
      const double part = part_at(edge, edge.centre + Vec{0, side * radius_of(edge)});
      if (part > 0 && part < 1) parts.push_back(part);
    }
    std::sort(parts.begin(), parts.end());
    for (std::size_t i = 0; i + 1 < parts.size(); ++i)
      add_rising({edge, point_at(edge, parts[i]), point_at(edge, parts[i + 1]),
                  point_at(edge, (parts[i] + parts[i + 1]) / 2).x > edge.centre.x});
  }

  std::vector<std::vector<double>>& rows() { return rows_; }
  std::size_t count() const { return count_; }
  double height(std::size_t row) const {
    return low_ + (static_cast<double>(row) + 0.5) * distance_;
  }

 private:
  /// A part of an edge whose height only grows or only falls.
  struct Part {
    const Edge& edge;
    Vec from, to;
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
      rows_[row].push_back(x_at(part, y));
      ++count_;
    }
  }

  static double x_at(const Part& part, double y) {
    const auto& [edge, from, to, is_right] = part;
    if (edge.is_line()) return from.x + (to.x - from.x) * (y - from.y) / (to.y - from.y);
    const double radius = radius_of(edge), up = y - edge.centre.y;
    const double half = std::sqrt(std::max(0.0, (radius - up) * (radius + up)));
    return edge.centre.x + (is_right ? half : -half);
  }

  double low_, distance_;
  std::vector<std::vector<double>> rows_;
  std::size_t count_ = 0;
};

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
  Crossings crossings(box, options.distance_mm);
  for (std::size_t i = 0; i < contours.size(); ++i) {
    const std::size_t before = crossings.count();
    for (std::size_t k = first_edges[i]; k < first_edges[i + 1]; ++k) crossings.add(edges[k]);
    if (missed != nullptr && contours[i].closed && crossings.count() == before)
      missed->push_back(i);
  }
  for (std::size_t i = 0; i < crossings.rows().size(); ++i) {
    std::vector<double>& row = crossings.rows()[i];
    std::sort(row.begin(), row.end());
    HatchRow pieces;
    for (std::size_t k = 0; k + 1 < row.size(); k += 2) {
      if (row[k + 1] - row[k] < min_piece_mm) continue;
      const double y = crossings.height(i);
      pieces.push_back({turned({row[k], y}, angle), turned({row[k + 1], y}, angle)});
    }
    if (!pieces.empty()) result.push_back(std::move(pieces));
  }
  return result;
}

}  // namespace lamplock::cutting
