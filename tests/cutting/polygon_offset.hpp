// Offsets of polygons by libpolyclipping, an oracle of the offset of lines and arcs.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <polyclipping/clipper.hpp>
#include <utility>
#include <vector>

#include "host/cutting/box_tree.hpp"
#include "host/cutting/contour.hpp"

namespace lamplock::test {

using Polygon = std::vector<cutting::Vec>;

/// Polygons of which no point is further than `tolerance_mm` from the contours.
inline std::vector<Polygon> polygons_of(const std::vector<cutting::Contour>& contours,
                                        double tolerance_mm) {
  std::vector<Polygon> polygons;
  for (const cutting::Contour& contour : contours) {
    Polygon& polygon = polygons.emplace_back();
    for (const cutting::Edge& edge : contour.edges) {
      int count = 1;
      if (!edge.is_line()) {
        const double step = 4 * std::asin(std::sqrt(tolerance_mm / 2 / cutting::radius_of(edge)));
        count = static_cast<int>(std::abs(edge.sweep) / step) + 1;
      }
      for (int i = 0; i < count; ++i)
        polygon.push_back(cutting::point_at(edge, static_cast<double>(i) / count));
    }
  }
  return polygons;
}

/// By libpolyclipping: outside contours counter-clockwise, holes clockwise; positive grows.
inline std::vector<Polygon> clipper_offset(const std::vector<Polygon>& polygons, double distance_mm,
                                           double arc_tolerance_mm) {
  constexpr double scale = 1e7;
  ClipperLib::Paths paths, offset;
  for (const Polygon& polygon : polygons) {
    ClipperLib::Path& path = paths.emplace_back();
    for (const cutting::Vec& p : polygon)
      path.emplace_back(std::llround(p.x * scale), std::llround(p.y * scale));
  }
  ClipperLib::ClipperOffset clipper(2, arc_tolerance_mm * scale);
  clipper.AddPaths(paths, ClipperLib::jtRound, ClipperLib::etClosedPolygon);
  clipper.Execute(offset, distance_mm * scale);
  std::vector<Polygon> result;
  for (const ClipperLib::Path& path : offset) {
    Polygon& polygon = result.emplace_back();
    for (const ClipperLib::IntPoint& p : path)
      polygon.push_back({static_cast<double>(p.X) / scale, static_cast<double>(p.Y) / scale});
  }
  return result;
}

/// The boundary of all that the polygons run around, by libpolyclipping.
inline std::vector<Polygon> clipper_simple(const std::vector<Polygon>& polygons) {
  constexpr double scale = 1e7;
  ClipperLib::Paths paths;
  for (const Polygon& polygon : polygons) {
    ClipperLib::Path& path = paths.emplace_back();
    for (const cutting::Vec& p : polygon)
      path.emplace_back(std::llround(p.x * scale), std::llround(p.y * scale));
  }
  ClipperLib::SimplifyPolygons(paths, ClipperLib::pftNonZero);
  std::vector<Polygon> result;
  for (const ClipperLib::Path& path : paths) {
    Polygon& polygon = result.emplace_back();
    for (const ClipperLib::IntPoint& p : path)
      polygon.push_back({static_cast<double>(p.X) / scale, static_cast<double>(p.Y) / scale});
  }
  return result;
}

inline double area_of(const Polygon& polygon) {
  double area = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
    area += cutting::cross(polygon[i], polygon[(i + 1) % polygon.size()]) / 2;
  return area;
}

/// The longest way from a point of `of` (vertices and middles of sides) to the nearest of `to`.
inline double furthest(const std::vector<Polygon>& of, const std::vector<Polygon>& to) {
  std::vector<cutting::Edge> sides;
  std::vector<cutting::Box> boxes;
  for (const Polygon& polygon : to) {
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      sides.push_back({polygon[i], polygon[(i + 1) % polygon.size()], {}, 0});
      if (sides.back().from == sides.back().to) sides.pop_back();
    }
  }
  boxes.reserve(sides.size());
  for (const cutting::Edge& side : sides) boxes.push_back(cutting::box_of(side));
  const cutting::BoxTree tree(boxes);
  double longest = 0;
  for (const Polygon& polygon : of) {
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      for (const cutting::Vec& at :
           {polygon[i], (polygon[i] + polygon[(i + 1) % polygon.size()]) * 0.5}) {
        double nearest = 1e9;
        for (double reach = 0.004; nearest > reach && reach < 1000; reach *= 4)
          tree.visit(cutting::Box{at, at}.grown(reach), [&](std::size_t k) {
            nearest = std::min(nearest, cutting::distance_to(sides[k], at));
          });
        longest = std::max(longest, nearest);
      }
    }
  }
  return longest;
}

}  // namespace lamplock::test
