#include "host/cutting/edge.hpp"

#include <algorithm>
#include <limits>
#include <numbers>
#include <utility>

namespace lamplock::cutting {
namespace {

using std::numbers::pi;

// Lines whose directions differ by less have no intersection that a double can hold.
constexpr double parallel = 1e-12;

bool is_on(const Edge& edge, const Vec& point, double near_mm) {
  return distance_to(edge, point) <= near_mm;
}

/// True if both lie on one line or circle.
bool share_a_carrier(const Edge& a, const Edge& b, double near_mm) {
  if (a.is_line() != b.is_line()) return false;
  if (!a.is_line())
    return distance(a.centre, b.centre) <= near_mm &&
           std::abs(radius_of(a) - radius_of(b)) <= near_mm;
  const Vec along = a.to - a.from;
  const double length = norm(along);
  return std::abs(cross(along, b.from - a.from)) <= near_mm * length &&
         std::abs(cross(along, b.to - a.from)) <= near_mm * length;
}

/// What rounding adds to a distance from an edge: the coordinates of the centre of an arc are as
/// large as its radius, and some ten of their roundings add up.
double rounding_of(const Edge& edge) {
  constexpr double roundings = 16;
  return edge.is_line() ? 0 : roundings * std::numeric_limits<double>::epsilon() * radius_of(edge);
}

void add_if_on_both(std::vector<Vec>& points, const Vec& point, const Edge& a, const Edge& b,
                    double near_mm) {
  if (is_on(a, point, near_mm + rounding_of(a)) && is_on(b, point, near_mm + rounding_of(b)))
    points.push_back(point);
}

void cross_lines(std::vector<Vec>& points, const Edge& a, const Edge& b, double near_mm) {
  const Vec along = a.to - a.from, other = b.to - b.from;
  const double sine = cross(along, other);
  if (std::abs(sine) <= parallel * norm(along) * norm(other)) return;
  const double part = cross(b.from - a.from, other) / sine;
  add_if_on_both(points, a.from + along * part, a, b, near_mm);
}

void cross_line_and_arc(std::vector<Vec>& points, const Edge& line, const Edge& arc,
                        double near_mm) {
  const Vec along = (line.to - line.from) * (1 / length_of(line));
  const Vec foot = line.from + along * dot(arc.centre - line.from, along);
  const double radius = radius_of(arc), away = distance(foot, arc.centre);
  if (away > radius + near_mm) return;
  const double half = std::sqrt(std::max(0.0, (radius - away) * (radius + away)));
  add_if_on_both(points, foot + along * half, line, arc, near_mm);
  if (half > 0) add_if_on_both(points, foot - along * half, line, arc, near_mm);
}

/// From the centre of the smaller circle: seen from that of a much larger one, the common chord is
/// so near to the rim that the length of the chord loses most of its digits.
void cross_arcs(std::vector<Vec>& points, const Edge& a, const Edge& b, double near_mm) {
  const Vec between = b.centre - a.centre;
  const double apart = norm(between), ra = radius_of(a), rb = radius_of(b);
  if (ra > rb) return cross_arcs(points, b, a, near_mm);
  if (apart > ra + rb + near_mm || apart < std::abs(ra - rb) - near_mm || apart == 0) return;
  const Vec along = between * (1 / apart);
  const double foot = (apart + (ra - rb) * (ra + rb) / apart) / 2;
  const double half = std::sqrt(std::max(0.0, (ra - foot) * (ra + foot)));
  const Vec middle = a.centre + along * std::clamp(foot, -ra, ra);
  add_if_on_both(points, middle + right_of(along) * half, a, b, near_mm);
  if (half > 0) add_if_on_both(points, middle - right_of(along) * half, a, b, near_mm);
}

/// True if an arc has a point in this direction from its centre, other than its ends. Without the
/// angle of that point, which takes longer.
bool is_within_sweep(const Edge& arc, const Vec& out) {
  Vec first = arc.from - arc.centre, last = arc.to - arc.centre;
  if (arc.sweep < 0) std::swap(first, last);
  if (std::abs(arc.sweep) <= pi) return cross(first, out) > 0 && cross(out, last) > 0;
  return !(cross(last, out) > 0 && cross(out, first) > 0);
}

}  // namespace

Vec turned(const Vec& p, double radians) {
  const double c = std::cos(radians), s = std::sin(radians);
  return {c * p.x - s * p.y, s * p.x + c * p.y};
}

Edge arc_from(const Vec& centre, const Vec& from, double sweep) {
  return {from, centre + turned(from - centre, sweep), centre, sweep};
}

double radius_of(const Edge& edge) { return distance(edge.from, edge.centre); }

double length_of(const Edge& edge) {
  return edge.is_line() ? distance(edge.from, edge.to) : radius_of(edge) * std::abs(edge.sweep);
}

double area_below(const Edge& edge) {
  const double triangle = cross(edge.from, edge.to) / 2;
  if (edge.is_line()) return triangle;
  const double radius = radius_of(edge);
  return triangle + radius * radius * (edge.sweep - std::sin(edge.sweep)) / 2;
}

Vec point_at(const Edge& edge, double part) {
  if (part == 0) return edge.from;
  if (part == 1) return edge.to;
  if (edge.is_line()) return edge.from + (edge.to - edge.from) * part;
  return edge.centre + turned(edge.from - edge.centre, edge.sweep * part);
}

Vec direction_at(const Edge& edge, double part) {
  if (edge.is_line()) return (edge.to - edge.from) * (1 / distance(edge.from, edge.to));
  const Vec out = point_at(edge, part) - edge.centre;
  return right_of(out) * ((edge.sweep > 0 ? -1 : 1) / norm(out));
}

double part_at(const Edge& edge, const Vec& point) {
  if (edge.is_line()) {
    const Vec along = edge.to - edge.from;
    return dot(point - edge.from, along) / dot(along, along);
  }
  const Vec start = edge.from - edge.centre, out = point - edge.centre;
  const double sweep = std::abs(edge.sweep);
  double angle = std::atan2(cross(start, out), dot(start, out)) * (edge.sweep > 0 ? 1 : -1);
  // The turn that is nearest to the middle of the arc.
  if (angle < sweep / 2 - pi) angle += 2 * pi;
  return angle / sweep;
}

double distance_to(const Edge& edge, const Vec& point) {
  const double part = part_at(edge, point);
  if (part <= 0 || part >= 1) return std::min(distance(point, edge.from), distance(point, edge.to));
  if (edge.is_line())
    return std::abs(cross(edge.to - edge.from, point - edge.from)) / length_of(edge);
  return std::abs(distance(point, edge.centre) - radius_of(edge));
}

Vec nearest_on(const Edge& edge, const Vec& point) {
  const double part = part_at(edge, point);
  if (part > 0 && part < 1) return point_at(edge, part);
  return distance(point, edge.from) <= distance(point, edge.to) ? edge.from : edge.to;
}

Edge reversed(const Edge& edge) { return {edge.to, edge.from, edge.centre, -edge.sweep}; }

Edge cut_out(const Edge& edge, double from, double to, const Vec& start, const Vec& end) {
  return {start, end, edge.centre, edge.sweep * (to - from)};
}

Edge with_ends(const Edge& edge, const Vec& from, const Vec& to) {
  if (edge.is_line()) return {from, to, {}, 0};
  const Vec before = edge.to - edge.from, after = to - from;
  const double square = dot(before, before);
  if (!(square > 0)) {
    return {from, to, edge.centre + (from - edge.from), edge.sweep};
  }
  // The similarity that maps the old chord to the new one, as a product of complex numbers.
  const double c = dot(before, after) / square, s = cross(before, after) / square;
  const Vec out = edge.centre - edge.from;
  return {from, to, from + Vec{c * out.x - s * out.y, s * out.x + c * out.y}, edge.sweep};
}

std::vector<Vec> intersections(const Edge& a, const Edge& b, double near_mm) {
  std::vector<Vec> points;
  if (share_a_carrier(a, b, near_mm)) {
    for (const Vec& end : {a.from, a.to}) {
      if (is_on(b, end, near_mm)) points.push_back(end);
    }
    for (const Vec& end : {b.from, b.to}) {
      if (is_on(a, end, near_mm)) points.push_back(end);
    }
  } else if (a.is_line() && b.is_line()) {
    cross_lines(points, a, b, near_mm);
  } else if (a.is_line()) {
    cross_line_and_arc(points, a, b, near_mm);
  } else if (b.is_line()) {
    cross_line_and_arc(points, b, a, near_mm);
  } else {
    cross_arcs(points, a, b, near_mm);
  }
  return points;
}

Approach approach_of(const Edge& a, const Edge& b) {
  constexpr double same_point_mm = 1e-9;
  if (const std::vector<Vec> points = intersections(a, b, same_point_mm); !points.empty())
    return {0, points.front()};
  Approach best{distance(a.from, nearest_on(b, a.from)), nearest_on(b, a.from)};
  const auto consider = [&best](const Vec& on_a, const Vec& on_b) {
    if (const double away = distance(on_a, on_b); away < best.distance_mm) best = {away, on_b};
  };
  consider(a.to, nearest_on(b, a.to));
  for (const Vec& end : {b.from, b.to}) consider(nearest_on(a, end), end);
  // Between their ends, arcs are nearest to another edge on a line through their centre.
  if (!a.is_line()) {
    const Vec on_b = nearest_on(b, a.centre);
    consider(nearest_on(a, on_b), on_b);
  }
  if (!b.is_line()) {
    const Vec on_a = nearest_on(a, b.centre);
    consider(on_a, nearest_on(b, on_a));
  }
  return best;
}

Overlap overlap_of(const Edge& a, const Edge& b, double near_mm) {
  if (!share_a_carrier(a, b, near_mm)) return {};
  std::vector<double> parts{0, 1};
  for (const Vec& end : {b.from, b.to}) {
    const double part = part_at(a, end);
    if (part > 0 && part < 1) parts.push_back(part);
  }
  std::sort(parts.begin(), parts.end());
  Overlap overlap;
  double longest = 0;
  for (std::size_t i = 0; i + 1 < parts.size(); ++i) {
    const double length = (parts[i + 1] - parts[i]) * length_of(a);
    const Vec middle = point_at(a, (parts[i] + parts[i + 1]) / 2);
    if (!is_on(b, middle, near_mm)) continue;
    overlap.length_mm += length;
    if (length > longest) overlap.middle = middle;
    longest = std::max(longest, length);
  }
  return overlap;
}

Box box_of(const Edge& edge) {
  Box box;
  box.add(edge.from);
  box.add(edge.to);
  if (edge.is_line()) return box;
  const double radius = radius_of(edge);
  for (const Vec& out : {Vec{1, 0}, Vec{0, 1}, Vec{-1, 0}, Vec{0, -1}}) {
    if (is_within_sweep(edge, out)) box.add(edge.centre + out * radius);
  }
  return box;
}

}  // namespace lamplock::cutting
