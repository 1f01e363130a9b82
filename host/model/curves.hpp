// Drawn curves: what DXF and SVG files hold and divide() takes. Arcs and splines are kept as what
// they are, so that points lie on the curve itself at exact arc length, and a cutter gets its arcs.
//
// In:  pieces from the readers. Out: the same placed elsewhere, polylines, the box.
// Who: read_dxf(), read_svg(), divide(), the command line.
//
// A path is a chain of pieces, each beginning where the one before ended. Every kind of piece stays
// of its kind under affine maps: an arc is held by two conjugate radii, so that circles may become
// ellipses, and a spline by its poles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "host/model/affine.hpp"
#include "host/points/bounds.hpp"
#include "host/points/point.hpp"

namespace lamplock::model {

struct Line {
  points::Point from, to;
};

/// centre + cos t * u + sin t * v for t from `start` to `end` (radians, either way round). A circle
/// if u and v are square to each other and of one length, an ellipse otherwise.
struct Arc {
  points::Point centre, u, v;
  double start = 0, end = 0;
};

/// A non-uniform rational B-spline (Piegl and Tiller, "The NURBS Book", 1997) from knots[degree] to
/// knots[poles.size()]. Bezier curves are those with knots 0..0 1..1.
struct Spline {
  int degree = 3;
  std::vector<double> knots;  ///< poles.size() + degree + 1, never falling
  std::vector<points::Point> poles;
  std::vector<double> weights;  ///< one a pole and positive; empty: all equal
};

using Piece = std::variant<Line, Arc, Spline>;

struct Path {
  std::vector<Piece> pieces;  ///< never empty
  bool closed = false;        ///< the last piece ends where the first begins
  std::uint32_t layer = 0;    ///< of Curves::layers
};

/// One drawing, mm.
struct Curves {
  std::vector<std::string> layers;  ///< names, in the order of first use
  std::vector<Path> paths;          ///< in the order of the file
  points::PointCloud points;        ///< single points (DXF POINT)
  /// What the reader found and could not use, by its name in the file ("TEXT", "image", ...).
  std::map<std::string, std::size_t> left_out;
};

/// How far a polyline or an end may be off: a tenth of the repeatability of the positioners in
/// "Mechatronic positioning of a pulsed laser beam in devices forming 3-D objects in glass".
inline constexpr double flat_mm = 0.001;

/// The most pieces and points of one drawing, copies of blocks included.
inline constexpr std::size_t most_pieces = 2'000'000;

/// Coordinates up to here (mm) still resolve far less than flat_mm.
inline constexpr double farthest_mm = 1e9;

/// The range of a piece's parameter: 0..1 for lines, radians for arcs, knots for splines.
struct Range {
  double from = 0, to = 1;
};
Range range_of(const Piece& piece);

/// Position and its derivative by the parameter.
struct Motion {
  points::Point at, speed;
};
Motion motion_at(const Piece& piece, double parameter);

points::Point start_of(const Path& path);
points::Point end_of(const Path& path);
/// Whether it ends within flat_mm of where it begins, as closed curves do whatever their file says.
bool returns_to_start(const Path& path);

/// What was left out as a user reads it: "2 HATCH, 3 TEXT"; empty if nothing.
std::string left_out_text(const Curves& curves);

/// Everything in its new place; exact for every affine map.
Piece transformed(Piece piece, const Affine& map);
Curves transformed(Curves curves, const Affine& map);

/// Vertices of a polyline that is nowhere further than `tolerance_mm` from the path; a closed path
/// ends in its first vertex. Splines are judged by samples. Throws Error (bad_input) if it needs
/// more vertices than points are allowed.
points::PointCloud flattened(const Path& path, double tolerance_mm = flat_mm);

/// The box round all paths, to flat_mm, and points; all zero if there is nothing.
points::Bounds bounds(const Curves& curves);

}  // namespace lamplock::model
