// Reference for curves: the true curve in long double, which has 64 bits for the 38 of a position.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "firmware/program/curves/curve.hpp"

namespace lamplock::program {

inline constexpr CurvePlane plane_xy{0, 1, 2}, plane_zx{2, 0, 1}, plane_yz{1, 2, 0};
inline constexpr long double two_pi_l = 2 * std::numbers::pi_v<long double>;

inline constexpr std::int64_t mm(double value) {
  return static_cast<std::int64_t>(value * 1e7 + (value < 0 ? -0.5 : 0.5));
}

/// All points of a curve, beginning with its start.
inline std::vector<Place> trace(Curve& curve, const Place& start) {
  std::vector<Place> places{start};
  Place at = start;
  while (curve.next(at)) places.push_back(at);
  EXPECT_FALSE(curve.active());
  EXPECT_EQ(places.size(), curve.pieces() + 1u);
  return places;
}

inline std::vector<Place> trace_rest(Curve& curve) {
  std::vector<Place> places;
  Place at{};
  while (curve.next(at)) places.push_back(at);
  return places;
}

struct Point {
  long double x, y;
};
inline Point operator-(Point a, Point b) { return {a.x - b.x, a.y - b.y}; }
inline long double length(Point a) { return std::hypot(a.x, a.y); }
inline Point in_plane(const Place& place, const CurvePlane& plane) {
  return {static_cast<long double>(place[plane.first]),
          static_cast<long double>(place[plane.second])};
}

/// Distance of a point from the piece between a and b.
inline long double distance(Point p, Point a, Point b) {
  const Point way = b - a, from = p - a;
  const long double square = way.x * way.x + way.y * way.y;
  if (square == 0) return length(from);
  const long double t = std::clamp((from.x * way.x + from.y * way.y) / square, 0.0L, 1.0L);
  return length(from - Point{t * way.x, t * way.y});
}

/// Deviations of a curve from the true one.
struct Errors {
  long double point = 0;  ///< largest distance of an end of a piece from the curve
  long double chord = 0;  ///< largest distance of the curve from its chord
  long double other = 0;  ///< deviation of the axes outside the plane from even motion
};

/// `curve_at(t)` is the true curve for t from 0 to 1.
template <class TrueCurve>
Errors errors_of(const std::vector<Place>& places, const CurvePlane& plane, TrueCurve curve_at) {
  Errors errors;
  const auto n = static_cast<long double>(places.size() - 1);
  const Place &start = places.front(), &end = places.back();
  for (std::size_t i = 1; i < places.size(); ++i) {
    const Point a = in_plane(places[i - 1], plane), b = in_plane(places[i], plane);
    const long double t = static_cast<long double>(i) / n;
    errors.point = std::max(errors.point, length(curve_at(t) - b));
    for (const long double part : {0.25L, 0.5L, 0.75L})
      errors.chord = std::max(errors.chord, distance(curve_at(t - part / n), a, b));
    for (const std::size_t axis : {std::size_t{plane.normal}, std::size_t{3}}) {
      const auto from = static_cast<long double>(start[axis]);
      const long double want = from + (static_cast<long double>(end[axis]) - from) * t;
      errors.other =
          std::max(errors.other, std::abs(static_cast<long double>(places[i][axis]) - want));
    }
  }
  return errors;
}

/// The true arc of a request, a spiral where the radii differ.
struct TrueArc {
  Point centre;
  long double start_radius, end_radius, start_angle, sweep;  ///< sweep negative = clockwise

  explicit TrueArc(const ArcRequest& r) : centre(in_plane(r.centre, r.plane)) {
    const Point a = in_plane(r.start, r.plane) - centre, b = in_plane(r.end, r.plane) - centre;
    start_radius = length(a);
    end_radius = length(b);
    start_angle = std::atan2(a.y, a.x);
    // Exact differences keep small angles exact.
    const Point way = in_plane(r.end, r.plane) - in_plane(r.start, r.plane);
    const long double across = a.x * way.y - a.y * way.x;
    sweep = std::atan2(across, a.x * b.x + a.y * b.y);
    if (r.clockwise) {
      if (sweep >= 0) sweep -= two_pi_l;
    } else if (sweep <= 0) {
      sweep += two_pi_l;
    }
    const long double turns = r.turns > 1 ? r.turns - 1 : 0;
    sweep += (r.clockwise ? -1 : 1) * turns * two_pi_l;
  }
  Point operator()(long double t) const {
    const long double radius = start_radius + (end_radius - start_radius) * t;
    const long double angle = start_angle + sweep * t;
    return {centre.x + radius * std::cos(angle), centre.y + radius * std::sin(angle)};
  }
  /// Distance between a round arc and the chord of one of its `pieces`.
  long double chord_error(long double pieces) const {
    const long double half = std::sin(std::abs(sweep) / pieces / 4);
    return start_radius * 2 * half * half;
  }
  long double length_with(long double other_way) const {
    long double plane = 0;
    constexpr int steps = 1000;  // middle rule
    for (int i = 0; i < steps; ++i) {
      const long double t = (static_cast<long double>(i) + 0.5L) / steps;
      const long double radius = start_radius + (end_radius - start_radius) * t;
      plane += std::hypot(radius * sweep, end_radius - start_radius) / steps;
    }
    return std::hypot(plane, other_way);
  }
};

inline long double other_way(const Place& start, const Place& end, const CurvePlane& plane) {
  return std::hypot(static_cast<long double>(end[plane.normal] - start[plane.normal]),
                    static_cast<long double>(end[3] - start[3]));
}

}  // namespace lamplock::program
