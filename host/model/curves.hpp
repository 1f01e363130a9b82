// Drawn curves of DXF and SVG files for divide(). Arcs and splines are stored exactly, so that
// points are on the curve itself at exact arc length, and a cutter gets arcs.
//
// In:  pieces from the readers. Out: mapped pieces, polylines, the bounding box.
// Who: read_dxf(), read_svg(), divide(), the command line.
//
// A path is a chain of pieces, each beginning at the end of the one before. Every kind of piece is
// closed under affine maps: an arc has two conjugate radii, so that circles may become ellipses,
// and a spline its poles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "host/geometry/affine.hpp"
#include "host/geometry/bounds.hpp"
#include "host/geometry/point.hpp"
#include "host/model/colour.hpp"

namespace lamplock::model {

struct Line {
  geometry::Point from, to;
};

/// centre + cos t * u + sin t * v for t from `start` to `end` (radians, in either direction). A
/// circle if u and v are perpendicular and of equal length, otherwise an ellipse.
struct Arc {
  geometry::Point centre, u, v;
  double start = 0, end = 0;
};

/// A non-uniform rational B-spline (Piegl and Tiller, "The NURBS Book", 1997) from knots[degree] to
/// knots[poles.size()]. Bezier curves are those with knots 0..0 1..1.
struct Spline {
  int degree = 3;
  std::vector<double> knots;  ///< poles.size() + degree + 1, not decreasing
  std::vector<geometry::Point> poles;
  std::vector<double> weights;  ///< one per pole, positive; empty: all equal
};

using Piece = std::variant<Line, Arc, Spline>;

/// Which places are inside of an area, by how often its outline runs around them (W3C, "Scalable
/// Vector Graphics (SVG) 2", section 13.4.2).
enum class FillRule : std::uint8_t {
  even_odd,  ///< an odd number of times, in whatever direction
  non_zero   ///< not equally often in both directions
};

struct Path {
  std::vector<Piece> pieces;  ///< never empty
  bool closed = false;        ///< the last piece ends where the first begins
  FillRule fill_rule = FillRule::even_odd;
  bool covers = false;        ///< its area has the colour of the page: it hides those before it
  std::uint32_t layer = 0;    ///< of Curves::layers
  Colour colour = no_colour;  ///< of the line, otherwise of the area
  /// Paths with the same number are the outline of one filled area; areas have numbers in the order
  /// in which they are painted. 0: the file does not say what is filled.
  std::uint32_t area = 0;
};

/// One drawing, mm.
struct Curves {
  std::vector<std::string> layers;  ///< names, in the order of first use
  std::vector<Path> paths;          ///< in the order of the file
  geometry::PointCloud points;      ///< single points (DXF POINT)
  /// Count of entities that were not read, by their name in the file ("TEXT", "image", ...).
  std::map<std::string, std::size_t> left_out;
  std::vector<std::string> warnings;  ///< what the user has to know about the file
  /// False: the file names no unit, its numbers were taken as mm, as the last warning says.
  bool has_unit = true;
  double mm_per_unit = 1;  ///< of the numbers of a DXF
};

/// Tolerance of polylines and ends: a tenth of the repeatability of the positioners in "Mechatronic
/// positioning of a pulsed laser beam in devices forming 3-D objects in glass".
inline constexpr double flat_mm = 0.001;

/// Maximum number of pieces and points of one drawing, copies of blocks included.
inline constexpr std::size_t max_pieces = 2'000'000;

/// Up to this coordinate (mm) the resolution is far finer than flat_mm.
inline constexpr double farthest_mm = 1e9;

/// The range of a piece's parameter: 0..1 for lines, radians for arcs, knots for splines.
struct Range {
  double from = 0, to = 1;
};
Range range_of(const Piece& piece);

/// Position and its derivative by the parameter.
struct Motion {
  geometry::Point at, speed;
};
Motion motion_at(const Piece& piece, double parameter);

geometry::Point start_of(const Path& path);
geometry::Point end_of(const Path& path);
/// True if the path ends within flat_mm of its begin: such a path is closed even if the file does
/// not mark it.
bool returns_to_start(const Path& path);

/// Text about entities left out: "2 HATCH, 3 TEXT"; empty if there are none.
std::string left_out_text(const Curves& curves);

/// Applies a map; exact for every affine map.
Piece transformed(Piece piece, const geometry::Affine& map);
Curves transformed(Curves curves, const geometry::Affine& map);

/// Vertices of a polyline that is nowhere further than `tolerance_mm` from the path; a closed path
/// ends in its first vertex. For splines the distance is sampled. Throws Error (bad_input) if it
/// needs more vertices than points are allowed.
geometry::PointCloud flattened(const Path& path, double tolerance_mm = flat_mm);

/// The bounding box of all paths, to flat_mm, and points; all zero if there are none.
geometry::Bounds bounds(const Curves& curves);

}  // namespace lamplock::model
