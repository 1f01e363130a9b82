#include "host/cutting/leads.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "host/cutting/contour_walk.hpp"
#include "host/error.hpp"
#include "host/geometry/limits.hpp"

namespace lamplock::cutting {
namespace {

constexpr const char *lead_in_place = "lead-in", *lead_out_place = "lead-out";
constexpr double max_arc_deg = 270;
// Edges that meet are the same point to this.
constexpr double same_point_mm = 1e-9;
// A lead and the contour that it touches are one for this length: the root of the rounding of
// coordinates of a metre.
constexpr double touch_mm = 1e-4;

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

void require_shape(const Contour& contour, const Lead& lead, const char* place) {
  if (!contour.closed)
    throw Error(Exit::bad_input, place, "an open contour has no waste side",
                "use leads for closed contours only");
  geometry::require_positive(lead.angle_deg, place, "angle");
  const bool is_line = lead.shape == LeadShape::line;
  geometry::require_positive(is_line ? lead.length_mm : lead.radius_mm, place,
                             is_line ? "length" : "radius");
  if (is_line ? lead.angle_deg >= 180 : lead.angle_deg > max_arc_deg)
    throw Error(Exit::bad_input, place, fmt::format("the angle is {:g} degrees", lead.angle_deg),
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

/// A lead from a point on a contour.
class FittingLead {
 public:
  /// `side` is that of the waste, seen in `direction`.
  FittingLead(const Vec& at, const Vec& direction, WasteSide side, const Contour& contour,
              const LeadOptions& options, const CutSheet& sheet, const char* place)
      : at_(at),
        direction_(direction),
        side_(side),
        contour_(contour),
        options_(options),
        sheet_(sheet),
        place_(place) {}

  Edge edge() const {
    Edge lead = lead_from(at_, direction_, options_.shape, side_);
    const std::string fault = fault_of(lead);
    if (fault.empty()) return lead;
    throw LeadError(
        place_, fmt::format("the lead at ({:.3f}, {:.3f}) does not fit: {}", at_.x, at_.y, fault),
        fitting_mm());
  }

 private:
  /// Empty if the lead fits.
  std::string fault_of(const Edge& lead) const {
    if (!sheet_.is_free(lead, at_, touch_mm)) return "it meets a contour";
    // It meets its own contour at its begin alone, so that all of it is on the side of its end.
    const bool is_ccw = is_counter_clockwise(contour_);
    const bool is_inside_waste = is_ccw == (options_.waste == WasteSide::left);
    if (is_inside(contour_, lead.to) != is_inside_waste) return "it is in the part";
    if (sheet_.room(lead.to, options_.clearance_mm) < options_.clearance_mm)
      return fmt::format(
          "its other end is nearer than {:g} mm, half the kerf, to the middle of a cut",
          options_.clearance_mm);
    if (options_.neighbours.are_cut_by(lead, options_.clearance_mm))
      return "it cuts into another contour, which is nearer than the kerf";
    return "";
  }

  bool fits(double size_mm) const {
    Lead lead = options_.shape;
    lead.length_mm = lead.radius_mm = size_mm;
    return size_mm > 0 && fault_of(lead_from(at_, direction_, lead, side_)).empty();
  }

  /// The nearest size that fits, to 0.01 mm; 0 if there is none.
  double fitting_mm() const {
    constexpr double factor = 1.2, step_mm = 0.01;
    constexpr int tries = 20;
    const double size_mm = options_.shape.shape == LeadShape::line ? options_.shape.length_mm
                                                                   : options_.shape.radius_mm;
    for (int i = 1; i <= tries; ++i) {
      for (const int sign : {-1, 1}) {
        double good_mm = size_mm * std::pow(factor, sign * i);
        if (!fits(good_mm)) continue;
        double bad_mm = size_mm * std::pow(factor, sign * (i - 1));
        while (std::abs(good_mm - bad_mm) > step_mm / 16) {
          const double middle_mm = (good_mm + bad_mm) / 2;
          (fits(middle_mm) ? good_mm : bad_mm) = middle_mm;
        }
        // The nearest step may be just beyond the limit.
        for (const double steps : {std::round(good_mm / step_mm), std::floor(good_mm / step_mm),
                                   std::ceil(good_mm / step_mm)})
          if (fits(steps * step_mm)) return steps * step_mm;
      }
    }
    return 0;
  }

  const Vec at_, direction_;
  const WasteSide side_;
  const Contour& contour_;
  const LeadOptions& options_;
  const CutSheet& sheet_;
  const char* place_;
};

}  // namespace

LeadError::LeadError(const char* place, const std::string& what, double fitting_mm)
    : Error(Exit::bad_input, place, what,
            fitting_mm > 0
                ? fmt::format("use a lead of {:g} mm, which fits there, or none", fitting_mm)
                : "use no lead, or one of another shape or angle"),
      fitting_mm_(fitting_mm) {}

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
  require_shape(contour, options.shape, lead_in_place);
  const Edge& first = contour.edges.front();
  const WasteSide other = options.waste == WasteSide::right ? WasteSide::left : WasteSide::right;
  const Vec back = direction_at(first, 0) * -1;
  return {reversed(
      FittingLead(first.from, back, other, contour, options, sheet, lead_in_place).edge())};
}

std::vector<Edge> lead_out(const Contour& contour, double along_mm, const LeadOptions& options,
                           const CutSheet& sheet) {
  if (options.shape.shape == LeadShape::none) return {};
  require_shape(contour, options.shape, lead_out_place);
  // At the begin the beam arrives in the direction of the last edge.
  const ContourPoint end =
      along_mm > 0 ? point_along(contour, along_mm) : ContourPoint{contour.edges.size() - 1, 1};
  const Edge& edge = contour.edges[end.edge];
  const FittingLead lead(point_at(edge, end.part), direction_at(edge, end.part), options.waste,
                         contour, options, sheet, lead_out_place);
  return {lead.edge()};
}

}  // namespace lamplock::cutting
