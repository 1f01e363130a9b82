// Lines and circular arcs in the plane of the sheet, the pieces that cut contours are made of.
//
// In:  points in mm. Out: lengths, points, distances and intersections, exact to rounding.
// Who: the contours of a drawing, their compensation and their order.
//
// A machine executes lines and arcs (G1, G2, G3), and both stay lines and arcs when they are
// offset, so that no curve has to be replaced by chords between the drawing and the machine.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace lamplock::cutting {

/// A point or a difference of points in the plane of the sheet, mm.
struct Vec {
  double x = 0, y = 0;
  friend bool operator==(const Vec&, const Vec&) = default;
};
inline Vec operator+(const Vec& p, const Vec& q) { return {p.x + q.x, p.y + q.y}; }
inline Vec operator-(const Vec& p, const Vec& q) { return {p.x - q.x, p.y - q.y}; }
inline Vec operator*(const Vec& p, double factor) { return {p.x * factor, p.y * factor}; }
inline double dot(const Vec& p, const Vec& q) { return p.x * q.x + p.y * q.y; }
/// Positive if q points to the left of p.
inline double cross(const Vec& p, const Vec& q) { return p.x * q.y - p.y * q.x; }
/// Coordinates are far from the range where std::hypot, which is several times slower, is needed.
inline double norm(const Vec& p) { return std::sqrt(dot(p, p)); }
inline double distance(const Vec& p, const Vec& q) { return norm(p - q); }
/// The same length, a quarter turn clockwise: to the right of a direction.
inline Vec right_of(const Vec& p) { return {p.y, -p.x}; }
/// Counter-clockwise about the origin.
Vec turned(const Vec& p, double radians);

/// A line, or a circular arc if `sweep` is not 0.
struct Edge {
  Vec from, to;
  Vec centre;        ///< of an arc
  double sweep = 0;  ///< angle of an arc in radians, positive counter-clockwise, up to a full turn
  bool is_line() const { return sweep == 0; }
};

/// The arc about `centre` that begins at `from`; its end follows from the sweep.
Edge arc_from(const Vec& centre, const Vec& from, double sweep);
double radius_of(const Edge& edge);
double length_of(const Edge& edge);
/// The part of the signed area (mm^2, positive counter-clockwise) between the edge and the origin.
double area_below(const Edge& edge);

/// The point and the unit direction at `part` of the length, 0..1; 0 and 1 are the exact ends.
Vec point_at(const Edge& edge, double part);
Vec direction_at(const Edge& edge, double part);
/// The part of the length at which the point projects onto the edge; beyond 0..1 outside of it.
double part_at(const Edge& edge, const Vec& point);
double distance_to(const Edge& edge, const Vec& point);
/// The point of the edge that is nearest to another.
Vec nearest_on(const Edge& edge, const Vec& point);

Edge reversed(const Edge& edge);
/// The edge from one part of the length to another, with these exact ends.
Edge cut_out(const Edge& edge, double from, double to, const Vec& start, const Vec& end);
/// The edge with its ends moved to these points; an arc keeps its sweep. For distances that are
/// small against the length.
Edge with_ends(const Edge& edge, const Vec& from, const Vec& to);

/// Points that two edges share, to `near_mm`: crossings, touches, and of edges that overlap the
/// ends of the common part.
std::vector<Vec> intersections(const Edge& a, const Edge& b, double near_mm);
/// Where two edges are nearest to each other.
struct Approach {
  double distance_mm = 0;
  Vec at;  ///< on the second edge
};
Approach approach_of(const Edge& a, const Edge& b);
/// Length of the part of both edges that is the same line or arc to `near_mm`, and its middle.
struct Overlap {
  double length_mm = 0;
  Vec middle;
};
Overlap overlap_of(const Edge& a, const Edge& b, double near_mm);

/// An axis-parallel rectangle; by default an empty one that any other enlarges.
struct Box {
  Vec low{1e300, 1e300}, high{-1e300, -1e300};
  void add(const Vec& point) {
    low = {std::min(low.x, point.x), std::min(low.y, point.y)};
    high = {std::max(high.x, point.x), std::max(high.y, point.y)};
  }
  void add(const Box& box) {
    low = {std::min(low.x, box.low.x), std::min(low.y, box.low.y)};
    high = {std::max(high.x, box.high.x), std::max(high.y, box.high.y)};
  }
  Box grown(double by_mm) const {
    return {{low.x - by_mm, low.y - by_mm}, {high.x + by_mm, high.y + by_mm}};
  }
  bool meets(const Box& other) const {
    return low.x <= other.high.x && other.low.x <= high.x && low.y <= other.high.y &&
           other.low.y <= high.y;
  }
  bool contains(const Box& other) const {
    return low.x <= other.low.x && low.y <= other.low.y && high.x >= other.high.x &&
           high.y >= other.high.y;
  }
};
Box box_of(const Edge& edge);

}  // namespace lamplock::cutting
