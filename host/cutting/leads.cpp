#include "host/cutting/leads.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <utility>

#include "host/cutting/contour_walk.hpp"
#include "host/error.hpp"
#include "host/geometry/limits.hpp"

namespace lamplock::cutting {
namespace {

constexpr const char* lead_place = "lead";
constexpr double max_arc_deg = 270;
// Edges that meet are the same point to this.
constexpr double same_point_mm = 1e-9;
// A lead and the contour that it touches are one for this length: the root of the rounding of
// coordinates of a metre.
constexpr double touch_mm = 1e-4;

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

[[noreturn]] void refuse(const Vec& at, const std::string& why) {
  throw Error(Exit::bad_input, lead_place,
              fmt::format("the lead at ({:.3f}, {:.3f}) does not fit: {}", at.x, at.y, why),
              "use a shorter lead, another start point, or no lead");
}

void require_shape(const Contour& contour, const Lead& lead) {
  if (!contour.closed)
    throw Error(Exit::bad_input, lead_place, "an open contour has no waste side",
                "use leads for closed contours only");
  geometry::require_positive(lead.angle_deg, lead_place, "angle");
  const bool is_line = lead.shape == LeadShape::line;
  geometry::require_positive(is_line ? lead.length_mm : lead.radius_mm, lead_place,
                             is_line ? "length" : "radius");
  if (is_line ? lead.angle_deg >= 180 : lead.angle_deg > max_arc_deg)
    throw Error(Exit::bad_input, lead_place,
                fmt::format("the angle is {:g} degrees", lead.angle_deg),
                is_line ? "use less than 180 degrees" : "use at most 270 degrees");
}

/// A lead-out in the direction of the contour at a point. A lead-in is one of the contour that runs
/// the other way, with the waste on the other side.
Edge lead_from(const Vec& at, const Vec& direction, const Lead& lead, WasteSide waste) {
  // To the right a turn is negative.
  const double side = waste == WasteSide::right ? -1 : 1, angle = side * radians(lead.angle_deg);
  if (lead.shape == LeadShape::line)
    return {at, at + turned(direction, angle) * lead.length_mm, {}, 0};
  const Vec centre = at + right_of(direction) * (-side * lead.radius_mm);
  return arc_from(centre, at, angle);
}

void require_fit(const Edge& lead, const Contour& contour, const LeadOptions& options,
                 const CutSheet& sheet) {
  const Vec &at = lead.from, &end = lead.to;
  if (!sheet.is_free(lead, at, touch_mm)) refuse(at, "it meets a contour");
  // It meets its own contour at its begin alone, so that all of it is on the side of its end.
  const bool is_ccw = is_counter_clockwise(contour);
  const bool is_inside_waste = is_ccw == (options.waste == WasteSide::left);
  if (is_inside(contour, end) != is_inside_waste) refuse(at, "it is in the part");
  if (sheet.room(end, options.clearance_mm) < options.clearance_mm)
    refuse(at,
           fmt::format("its other end is nearer than {:g} mm to a contour", options.clearance_mm));
}

}  // namespace

CutSheet::CutSheet(const std::vector<Contour>& contours) : tree_({}) {
  for (const Contour& contour : contours)
    edges_.insert(edges_.end(), contour.edges.begin(), contour.edges.end());
  tree_ = tree_of(edges_);
}

bool CutSheet::is_free(const Edge& edge, const Vec& at, double near_mm) const {
  return !tree_.any(box_of(edge).grown(same_point_mm), [&](std::size_t i) {
    const std::vector<Vec> points = intersections(edge, edges_[i], same_point_mm);
    return std::any_of(points.begin(), points.end(),
                       [&](const Vec& point) { return distance(point, at) > near_mm; });
  });
}

double CutSheet::room(const Vec& at, double reach_mm) const {
  double nearest = reach_mm;
  tree_.any_near(at, reach_mm, [&](std::size_t i) {
    nearest = std::min(nearest, distance_to(edges_[i], at));
    return false;
  });
  return nearest;
}

std::vector<Edge> lead_in(const Contour& contour, const LeadOptions& options,
                          const CutSheet& sheet) {
  if (options.shape.shape == LeadShape::none) return {};
  require_shape(contour, options.shape);
  const Edge& first = contour.edges.front();
  const WasteSide other = options.waste == WasteSide::right ? WasteSide::left : WasteSide::right;
  const Edge away = lead_from(first.from, direction_at(first, 0) * -1, options.shape, other);
  require_fit(away, contour, options, sheet);
  return {reversed(away)};
}

std::vector<Edge> lead_out(const Contour& contour, double along_mm, const LeadOptions& options,
                           const CutSheet& sheet) {
  if (options.shape.shape == LeadShape::none) return {};
  require_shape(contour, options.shape);
  // At the begin the beam arrives in the direction of the last edge.
  const ContourPoint end =
      along_mm > 0 ? point_along(contour, along_mm) : ContourPoint{contour.edges.size() - 1, 1};
  const Edge& edge = contour.edges[end.edge];
  const Edge away = lead_from(point_at(edge, end.part), direction_at(edge, end.part), options.shape,
                              options.waste);
  require_fit(away, contour, options, sheet);
  return {away};
}

}  // namespace lamplock::cutting
