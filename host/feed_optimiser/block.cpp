#include "host/feed_optimiser/block.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "host/error.hpp"

namespace lamplock::feed_optimiser {
namespace {

using std::numbers::pi;

/// Half of the patent's tolerance of an end point. Programs have arcs whose radii at both ends
/// differ by the rounding of their numbers.
constexpr double max_off_arc_mm = 0.005;
constexpr const char* block_axis_names = "XYZ";

PerAxis per_axis(const Point& p) { return {p.x, p.y, p.z}; }
Point point_of(const PerAxis& p) { return {p[0], p[1], p[2]}; }

PerAxis difference(const Point& from, const Point& to) {
  return {to.x - from.x, to.y - from.y, to.z - from.z};
}
double length_of(const PerAxis& v) { return std::hypot(v[0], v[1], v[2]); }

/// Centre of the circle through three places of a plane; false if they are in a line.
bool centre_of(const std::array<std::array<double, 2>, 3>& p, Arc& arc) {
  const double bx = p[1][0] - p[0][0], by = p[1][1] - p[0][1];
  const double cx = p[2][0] - p[0][0], cy = p[2][1] - p[0][1];
  const double d = 2 * (bx * cy - by * cx);
  const double b = bx * bx + by * by, c = cx * cx + cy * cy;
  if (std::abs(d) < 1e-9 * std::max(b, c)) return false;
  const double x = (cy * b - by * c) / d, y = (bx * c - cx * b) / d;
  arc.centre_first = p[0][0] + x;
  arc.centre_second = p[0][1] + y;
  arc.radius_mm = std::hypot(x, y);
  return true;
}

/// The arc about one axis through all vertices.
std::optional<Arc> arc_about(std::span<const Point> vertices, std::size_t along) {
  Arc arc;
  arc.along = along;
  arc.first = (along + 1) % axes;
  arc.second = (along + 2) % axes;
  const auto plane = [&](const Point& p) {
    return std::array<double, 2>{per_axis(p)[arc.first], per_axis(p)[arc.second]};
  };
  // A full circle ends where it begins: the last vertex is not one of the three.
  const std::size_t count = vertices.size(), third = count > 3 ? count * 2 / 3 : count - 1;
  if (!centre_of({plane(vertices[0]), plane(vertices[third / 2]), plane(vertices[third])}, arc))
    return std::nullopt;
  const auto angle = [&](const Point& p) {
    const auto at = plane(p);
    return std::atan2(at[1] - arc.centre_second, at[0] - arc.centre_first);
  };
  arc.start_rad = angle(vertices[0]);
  arc.from_along = per_axis(vertices[0])[along];
  std::vector<double> swept{0};
  for (std::size_t i = 1; i < count; ++i) {
    const double turn = std::remainder(angle(vertices[i]) - angle(vertices[i - 1]), 2 * pi);
    swept.push_back(swept.back() + turn);
  }
  arc.sweep_rad = swept.back();
  arc.rise_mm = per_axis(vertices.back())[along] - arc.from_along;
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = plane(vertices[i]);
    const double radius = std::hypot(at[0] - arc.centre_first, at[1] - arc.centre_second);
    const double part = swept[i] / arc.sweep_rad;
    const double off = per_axis(vertices[i])[along] - arc.from_along - part * arc.rise_mm;
    if (!(part >= -1e-9 && part <= 1 + 1e-9)) return std::nullopt;
    if (std::abs(radius - arc.radius_mm) > max_off_arc_mm || std::abs(off) > max_off_arc_mm)
      return std::nullopt;
  }
  return arc;
}

/// Limits along an arc. With v <= sqrt(a r / sqrt 2) and a_t <= a / sqrt 2 the vector of the
/// acceleration, (a_t, v^2 / r), is at most a. That of the jerk is (j_t - v^3 / r^2, 3 v a_t / r):
/// v^3 / r^2 <= j / 4, j_t <= j / 2 and 3 v a_t / r <= 0.66 j keep it below j.
PathLimits arc_limits(double radius, const PathLimits& of_axes) {
  const double a = of_axes.accel_mm_s2, j = of_axes.jerk_mm_s3;
  PathLimits limits;
  limits.speed_mm_s = std::min({of_axes.speed_mm_s, std::sqrt(a * radius / std::numbers::sqrt2),
                                std::cbrt(j * radius * radius / 4)});
  limits.accel_mm_s2 = std::min(a / std::numbers::sqrt2, 0.22 * j * radius / limits.speed_mm_s);
  limits.jerk_mm_s3 = j / 2;
  return limits;
}

}  // namespace

void require_limits(const AxisLimits& limits) {
  const auto require = [](const PerAxis& values, const char* name, const char* unit) {
    for (std::size_t a = 0; a < axes; ++a)
      if (!std::isfinite(values[a]) || values[a] <= 0)
        throw Error(
            Exit::bad_input, name,
            fmt::format("{:g} {} for {} is not a limit", values[a], unit, block_axis_names[a]),
            "choose a finite number greater than 0");
  };
  require(limits.speed_mm_s, "speed limit", "mm/s");
  require(limits.accel_mm_s2, "acceleration limit", "mm/s2");
  require(limits.jerk_mm_s3, "jerk limit", "mm/s3");
}

Point Block::at(double s_mm) const {
  const double part = s_mm / length_mm;
  if (!arc) {
    const PerAxis way = difference(from, to);
    return {from.x + way[0] * part, from.y + way[1] * part, from.z + way[2] * part};
  }
  const double angle = arc->start_rad + arc->sweep_rad * part;
  PerAxis place{};
  place[arc->first] = arc->centre_first + arc->radius_mm * std::cos(angle);
  place[arc->second] = arc->centre_second + arc->radius_mm * std::sin(angle);
  place[arc->along] = arc->from_along + arc->rise_mm * part;
  const PerAxis begin = per_axis(arc->begin_off), end = per_axis(arc->end_off);
  for (std::size_t a = 0; a < axes; ++a) place[a] += begin[a] + (end[a] - begin[a]) * part;
  return point_of(place);
}

Block straight_block(const Point& from, const Point& to) {
  Block block;
  block.from = from;
  block.to = to;
  block.length_mm = length_of(difference(from, to));
  return block;
}

std::optional<Block> arc_block(std::span<const Point> vertices) {
  for (const std::size_t along : {2UL, 1UL, 0UL}) {
    const std::optional<Arc> arc = arc_about(vertices, along);
    if (!arc) continue;
    Block block;
    block.from = vertices.front();
    block.to = vertices.back();
    block.arc = arc;
    block.length_mm = std::hypot(arc->radius_mm * arc->sweep_rad, arc->rise_mm);
    const Point begin = block.at(0), end = block.at(block.length_mm);
    block.arc->begin_off = point_of(difference(begin, block.from));
    block.arc->end_off = point_of(difference(end, block.to));
    return block;
  }
  return std::nullopt;
}

PathLimits path_limits(const Block& block, const AxisLimits& limits) {
  // The largest part of the motion that an axis can have: its direction cosine.
  PerAxis part{};
  if (block.arc) {
    const double flat = std::abs(block.arc->radius_mm * block.arc->sweep_rad) / block.length_mm;
    part[block.arc->first] = part[block.arc->second] = flat;
    part[block.arc->along] = std::abs(block.arc->rise_mm) / block.length_mm;
  } else {
    const PerAxis way = difference(block.from, block.to);
    for (std::size_t a = 0; a < axes; ++a) part[a] = std::abs(way[a]) / block.length_mm;
  }
  constexpr double inf = std::numeric_limits<double>::infinity();
  PathLimits path{inf, inf, inf};
  for (std::size_t a = 0; a < axes; ++a) {
    if (part[a] <= 0) continue;
    path.speed_mm_s = std::min(path.speed_mm_s, limits.speed_mm_s[a] / part[a]);
    path.accel_mm_s2 = std::min(path.accel_mm_s2, limits.accel_mm_s2[a] / part[a]);
    path.jerk_mm_s3 = std::min(path.jerk_mm_s3, limits.jerk_mm_s3[a] / part[a]);
  }
  path.speed_mm_s = std::min(path.speed_mm_s, block.feed_mm_s);
  if (!block.arc) return path;
  // A helix bends less than its circle: radius / flat^2.
  const double flat = part[block.arc->first];
  return arc_limits(block.arc->radius_mm / (flat * flat), path);
}

double printed_jerk_limit(const Block& block, const AxisLimits& limits) {
  double squares = 0;
  const PerAxis way = difference(block.from, block.to);
  for (std::size_t a = 0; a < axes; ++a) {
    const bool moves = block.arc ? a != block.arc->along || block.arc->rise_mm != 0 : way[a] != 0;
    if (moves) squares += limits.jerk_mm_s3[a] * limits.jerk_mm_s3[a];
  }
  return std::sqrt(squares);
}

}  // namespace lamplock::feed_optimiser
