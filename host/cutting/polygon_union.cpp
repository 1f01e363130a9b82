#include "host/cutting/polygon_union.hpp"

#include <cmath>
#include <polyclipping/clipper.hpp>

#include "host/error.hpp"

namespace lamplock::cutting {
namespace {

// The library has coordinates of 63 bits; a few bits less for the sums it makes.
constexpr double max_coordinate = 1e18;

ClipperLib::PolyFillType type_of(FillRule rule) {
  switch (rule) {
    case FillRule::positive:
      return ClipperLib::pftPositive;
    case FillRule::negative:
      return ClipperLib::pftNegative;
    case FillRule::non_zero:
      break;
  }
  return ClipperLib::pftNonZero;
}

}  // namespace

std::vector<Polygon> united(const std::vector<Polygon>& polygons, FillRule rule) {
  ClipperLib::Clipper clipper;
  clipper.PreserveCollinear(true);
  for (const Polygon& polygon : polygons) {
    ClipperLib::Path path;
    path.reserve(polygon.size());
    for (const Vec& p : polygon) {
      const Vec scaled = p * (1 / union_grid_mm);
      if (!(std::abs(scaled.x) < max_coordinate && std::abs(scaled.y) < max_coordinate))
        throw Error(Exit::bad_input, "compensation", "a contour is too far from the origin",
                    "move the drawing to the origin");
      path.emplace_back(std::llround(scaled.x), std::llround(scaled.y));
    }
    clipper.AddPath(path, ClipperLib::ptSubject, true);
  }
  ClipperLib::Paths paths;
  clipper.Execute(ClipperLib::ctUnion, paths, type_of(rule), type_of(rule));
  std::vector<Polygon> result;
  result.reserve(paths.size());
  for (const ClipperLib::Path& path : paths) {
    Polygon& polygon = result.emplace_back();
    polygon.reserve(path.size());
    for (const ClipperLib::IntPoint& p : path)
      polygon.push_back(Vec{static_cast<double>(p.X), static_cast<double>(p.Y)} * union_grid_mm);
  }
  return result;
}

}  // namespace lamplock::cutting
