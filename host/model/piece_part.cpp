#include "host/model/piece_part.hpp"

#include <utility>
#include <vector>

#include "host/model/spline.hpp"

namespace lamplock::model {
namespace {

using geometry::Point;

/// The blossom of a Bezier curve: its value where all arguments are equal. The pole i of the part
/// from s to t has i arguments t, the others s (Farin, "Curves and Surfaces for CAGD").
Point blossom(std::vector<Point> poles, const std::vector<double>& arguments) {
  for (std::size_t level = 0; level < arguments.size(); ++level) {
    const double t = arguments[level], r = 1 - t;
    for (std::size_t i = 0; i + level + 1 < poles.size(); ++i) {
      const Point &p = poles[i], &q = poles[i + 1];
      poles[i] = {r * p.x + t * q.x, r * p.y + t * q.y, r * p.z + t * q.z};
    }
  }
  return poles.front();
}

Piece part_of_bezier(const Spline& spline, double from, double to) {
  const std::size_t degree = spline.poles.size() - 1;
  std::vector<Point> poles;
  for (std::size_t i = 0; i <= degree; ++i) {
    std::vector<double> arguments(degree, from);
    for (std::size_t k = 0; k < i; ++k) arguments[k] = to;
    poles.push_back(blossom(spline.poles, arguments));
  }
  return bezier(std::move(poles));
}

}  // namespace

Piece part_of(const Piece& piece, double from, double to) {
  if (std::holds_alternative<Line>(piece))
    return Line{motion_at(piece, from).at, motion_at(piece, to).at};
  if (const auto* arc = std::get_if<Arc>(&piece)) return Arc{arc->centre, arc->u, arc->v, from, to};
  return part_of_bezier(std::get<Spline>(piece), from, to);
}

Path part_of(const Path& path, const ArcLength::Place& from, const ArcLength::Place& to) {
  Path part;
  part.layer = path.layer;
  for (std::size_t i = from.piece; i <= to.piece; ++i) {
    const Range range = range_of(path.pieces[i]);
    const double begin = i == from.piece ? from.parameter : range.from;
    const double end = i == to.piece ? to.parameter : range.to;
    if (begin == end) continue;
    const bool is_whole = begin == range.from && end == range.to;
    part.pieces.push_back(is_whole ? path.pieces[i] : part_of(path.pieces[i], begin, end));
  }
  return part;
}

}  // namespace lamplock::model
