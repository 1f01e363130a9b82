#include "host/cutting/raw_offset.hpp"

#include <cmath>
#include <numbers>
#include <optional>

namespace lamplock::cutting {
namespace {

// Corners that a join would lengthen by less are smooth.
constexpr double min_join_mm = 1e-7;
// Arcs of a smaller radius are points.
constexpr double min_radius_mm = 1e-9;

/// The edge to the right; none for an arc whose radius is used up: all its points would be nearer
/// to other points of the arc.
std::optional<Edge> moved_right(const Edge& edge, double distance_mm) {
  if (edge.is_line()) {
    const Vec aside = right_of(direction_at(edge, 0)) * distance_mm;
    return Edge{edge.from + aside, edge.to + aside, {}, 0};
  }
  const double radius = radius_of(edge);
  const double moved = radius + (edge.sweep > 0 ? distance_mm : -distance_mm);
  if (moved < min_radius_mm) return std::nullopt;
  const double scale = moved / radius;
  return Edge{edge.centre + (edge.from - edge.centre) * scale,
              edge.centre + (edge.to - edge.centre) * scale, edge.centre, edge.sweep};
}

class RawOffsetter {
 public:
  explicit RawOffsetter(const OffsetOptions& options) : options_(options) {}

  void add(const Contour& contour, std::size_t number) {
    for (std::size_t i = 0; i < contour.edges.size(); ++i) {
      const Edge& edge = contour.edges[i];
      if (const auto moved = moved_right(edge, options_.distance_mm))
        raw_.edges.push_back({*moved, number, 2 * i});
      const bool is_last = i + 1 == contour.edges.size();
      if (is_last && !contour.closed) continue;
      add_corner(edge.to, direction_at(edge, 1),
                 direction_at(contour.edges[is_last ? 0 : i + 1], 0), {{}, number, 2 * i + 1});
    }
  }

  RawOffset raw() && { return std::move(raw_); }

 private:
  /// Left turns are convex seen from the right. Right turns need no join: the edges intersect.
  void add_corner(const Vec& corner, const Vec& before, const Vec& after, RawEdge join) {
    double turn = std::atan2(cross(before, after), dot(before, after));
    // The tip of a spike, in whatever direction it is rounded.
    if (turn < -std::numbers::pi + 1e-9) turn = std::numbers::pi;
    if (turn * options_.distance_mm < min_join_mm) return;
    const Vec first = right_of(before) * options_.distance_mm;
    const Vec second = right_of(after) * options_.distance_mm;
    const double reach = 1 / std::cos(turn / 2);
    if (options_.join == Join::mitre && reach > 0 && reach <= options_.max_mitre) {
      const Vec middle = first + second;
      const Vec tip = corner + middle * (reach * options_.distance_mm / norm(middle));
      join.edge = {corner + first, tip, {}, 0};
      raw_.edges.push_back(join);
      join.edge = {tip, corner + second, {}, 0};
      raw_.edges.push_back(join);
      raw_.mitres.push_back({{corner, corner + first, tip, corner + second}});
      return;
    }
    join.edge = {corner + first, corner + second, corner, turn};
    raw_.edges.push_back(join);
  }

  const OffsetOptions& options_;
  RawOffset raw_;
};

}  // namespace

bool Mitre::contains(const Vec& point, double slack_mm) const {
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec &from = corners[i], &to = corners[(i + 1) % corners.size()];
    if (cross(to - from, point - from) <= slack_mm * distance(from, to)) return false;
  }
  return true;
}

RawOffset raw_offset(const std::vector<Contour>& contours, const OffsetOptions& options) {
  RawOffsetter offsetter(options);
  for (std::size_t i = 0; i < contours.size(); ++i) offsetter.add(contours[i], i);
  return std::move(offsetter).raw();
}

}  // namespace lamplock::cutting
