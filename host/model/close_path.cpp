#include "host/model/close_path.hpp"

#include <algorithm>
#include <cmath>
#include <variant>

#include "host/geometry/point.hpp"

namespace lamplock::model {
namespace {

using geometry::Point;

/// Points whose hull contains the piece: it is straight if these are on one line.
geometry::PointCloud hull_of(const Piece& piece) {
  if (const auto* line = std::get_if<Line>(&piece)) return {line->from, line->to};
  if (const auto* spline = std::get_if<Spline>(&piece)) return spline->poles;
  const Arc& arc = std::get<Arc>(piece);
  const auto corner = [&](double u, double v) {
    return Point{arc.centre.x + u * arc.u.x + v * arc.v.x, arc.centre.y + u * arc.u.y + v * arc.v.y,
                 arc.centre.z};
  };
  return {corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)};
}

bool has_area(const Path& path) {
  geometry::PointCloud points;
  for (const Piece& piece : path.pieces) {
    const geometry::PointCloud hull = hull_of(piece);
    points.insert(points.end(), hull.begin(), hull.end());
  }
  const auto from_start = [&](const Point& p) {
    return Point{p.x - points.front().x, p.y - points.front().y, 0};
  };
  Point along{};
  for (const Point& point : points) {
    const Point way = from_start(point);
    if (std::hypot(way.x, way.y) > std::hypot(along.x, along.y)) along = way;
  }
  const double length = std::hypot(along.x, along.y);
  return std::any_of(points.begin(), points.end(), [&](const Point& point) {
    const Point way = from_start(point);
    return std::abs(along.x * way.y - along.y * way.x) > flat_mm * length;
  });
}

}  // namespace

void close_around_area(Path& path) {
  if (path.closed || path.pieces.empty() || !has_area(path)) return;
  if (!returns_to_start(path)) path.pieces.emplace_back(Line{end_of(path), start_of(path)});
  path.closed = true;
}

}  // namespace lamplock::model
