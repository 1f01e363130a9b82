// A block: one straight line or arc, the path between two geometric points.
//
// In:  the end points of a line; the vertices of the chords of an arc. Out: places along it, its
//      length, and the limits that those of the axes leave along it. Who: optimise().
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "host/feed_optimiser/limits.hpp"
#include "host/geometry/point.hpp"

namespace lamplock::feed_optimiser {

using geometry::Point;

/// An arc or helix about an axis of the machine.
struct Arc {
  std::size_t first = 0, second = 1, along = 2;  ///< axes of its plane, axis of the helix
  double centre_first = 0, centre_second = 0, radius_mm = 0;
  double start_rad = 0, sweep_rad = 0;
  double from_along = 0, rise_mm = 0;
  /// From the fitted curve to the programmed ends: rounding, and radii that differ at both ends.
  Point begin_off{}, end_off{};
};

/// A bit for each of X, Y and Z.
inline constexpr std::uint8_t all_axes = 7;

struct Block {
  Point from{}, to{};
  std::optional<Arc> arc{};  ///< empty: a straight line
  double length_mm = 0;
  /// Programmed speed along the path; infinite: none.
  double feed_mm_s = std::numeric_limits<double>::infinity();
  bool rapid = false;
  /// A bit for each axis that has a place at the end: the others are where the machine is, which a
  /// program need not say.
  std::uint8_t placed_axes = all_axes;
  std::size_t line = 0;  ///< of the program, or number of the end point in the polyline

  /// The place at a distance from the begin.
  Point at(double s_mm) const;
};

Block straight_block(const Point& from, const Point& to);
/// The arc on which all vertices are to 0.005 mm, in their order; empty if there is none. At least
/// 3 vertices.
std::optional<Block> arc_block(std::span<const Point> vertices);

/// What the axes permit along a block at any place of it. On an arc, parts of acceleration and jerk
/// are reserved for the change of direction.
PathLimits path_limits(const Block& block, const AxisLimits& limits);

/// The jerk of the patent's tables: sqrt(sum of j^2) over the axes that move.
double printed_jerk_limit(const Block& block, const AxisLimits& limits);

}  // namespace lamplock::feed_optimiser
