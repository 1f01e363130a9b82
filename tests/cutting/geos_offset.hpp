// Offsets of contours by unions of GEOS, the second oracle of the offset of lines and arcs.
//
// In:  a part: an outside contour of lines and arcs, counter-clockwise, and holes. Out: polygons.
// Who: the test of the offset.
//
// The band of all points within the distance of the contours is the union of a rectangle about each
// line, a sector of a ring about each arc and a disc about each corner. A grown part is the part
// with the band, a shrunken one that without it. (GEOSBuffer is no oracle: it simplifies its input
// by a hundredth of the distance first.)
#pragma once

#include <geos_c.h>

#include <cmath>
#include <cstdarg>
#include <cstddef>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "tests/cutting/polygon_offset.hpp"

namespace lamplock::test {

class GeosOffset {
 public:
  explicit GeosOffset(double chords_mm) : chords_(chords_mm), geos_(GEOS_init_r(), GEOS_finish_r) {}

  /// Outside contours counter-clockwise, holes clockwise; a positive distance grows.
  std::vector<Polygon> offset(const std::vector<cutting::Contour>& part, double distance_mm) const {
    const Shape band = band_of(part, std::abs(distance_mm)), solid = solid_of(part);
    const Shape moved =
        distance_mm > 0
            ? Shape(GEOSUnion_r(geos_.get(), solid.get(), band.get()), destroyer())
            : Shape(GEOSDifference_r(geos_.get(), solid.get(), band.get()), destroyer());
    if (!moved) throw std::runtime_error("GEOS has no result");
    std::vector<Polygon> polygons;
    for (int i = 0; i < GEOSGetNumGeometries_r(geos_.get(), moved.get()); ++i) {
      const GEOSGeometry* one = GEOSGetGeometryN_r(geos_.get(), moved.get(), i);
      if (GEOSGeomTypeId_r(geos_.get(), one) != GEOS_POLYGON) continue;
      if (GEOSisEmpty_r(geos_.get(), one) != 0) continue;
      polygons.push_back(ring(GEOSGetExteriorRing_r(geos_.get(), one), true));
      for (int hole = 0; hole < GEOSGetNumInteriorRings_r(geos_.get(), one); ++hole)
        polygons.push_back(ring(GEOSGetInteriorRingN_r(geos_.get(), one, hole), false));
    }
    return polygons;
  }

 private:
  struct Destroyer {
    GEOSContextHandle_t geos;
    void operator()(GEOSGeometry* shape) const { GEOSGeom_destroy_r(geos, shape); }
  };
  using Shape = std::unique_ptr<GEOSGeometry, Destroyer>;
  Destroyer destroyer() const { return {geos_.get()}; }

  GEOSGeometry* closed_ring(const Polygon& polygon) const {
    std::vector<double> x, y;
    for (const cutting::Vec& p : polygon) {
      x.push_back(p.x);
      y.push_back(p.y);
    }
    x.push_back(polygon.front().x);
    y.push_back(polygon.front().y);
    return GEOSGeom_createLinearRing_r(
        geos_.get(), GEOSCoordSeq_copyFromArrays_r(geos_.get(), x.data(), y.data(), nullptr,
                                                   nullptr, static_cast<unsigned>(x.size())));
  }

  GEOSGeometry* filled(const Polygon& polygon) const {
    return GEOSGeom_createPolygon_r(geos_.get(), closed_ring(polygon), nullptr, 0);
  }

  Shape solid_of(const std::vector<cutting::Contour>& part) const {
    const std::vector<Polygon> polygons = polygons_of(part, chords_);
    std::vector<GEOSGeometry*> holes;
    for (std::size_t i = 1; i < polygons.size(); ++i) holes.push_back(closed_ring(polygons[i]));
    return Shape(GEOSGeom_createPolygon_r(geos_.get(), closed_ring(polygons.front()), holes.data(),
                                          static_cast<unsigned>(holes.size())),
                 destroyer());
  }

  Shape band_of(const std::vector<cutting::Contour>& part, double distance_mm) const {
    std::vector<GEOSGeometry*> pieces;
    for (const cutting::Contour& contour : part) {
      for (const cutting::Edge& edge : contour.edges) {
        pieces.push_back(filled(about(edge, distance_mm)));
        pieces.push_back(filled(disc(edge.from, distance_mm)));
      }
    }
    const Shape all(GEOSGeom_createCollection_r(geos_.get(), GEOS_MULTIPOLYGON, pieces.data(),
                                                static_cast<unsigned>(pieces.size())),
                    destroyer());
    return Shape(GEOSUnaryUnion_r(geos_.get(), all.get()), destroyer());
  }

  /// Parts of an arc between chords of at most the error.
  int parts_of(double radius, double sweep) const {
    const double step = 4 * std::asin(std::sqrt(chords_ / 2 / std::max(radius, chords_)));
    return static_cast<int>(std::abs(sweep) / step) + 1;
  }

  Polygon disc(const cutting::Vec& at, double radius) const {
    const int count = parts_of(radius, 2 * std::numbers::pi) + 2;
    Polygon polygon;
    for (int i = 0; i < count; ++i)
      polygon.push_back(at + cutting::turned({radius, 0}, 2 * std::numbers::pi * i / count));
    return polygon;
  }

  /// The points whose nearest one of the line or circle of the edge is on the edge.
  Polygon about(const cutting::Edge& edge, double distance_mm) const {
    if (edge.is_line()) {
      const cutting::Vec aside = cutting::right_of(cutting::direction_at(edge, 0)) * distance_mm;
      return {edge.from + aside, edge.to + aside, edge.to - aside, edge.from - aside};
    }
    const double radius = cutting::radius_of(edge);
    const double outer = (radius + distance_mm) / radius;
    const double inner = std::max(0.0, radius - distance_mm) / radius;
    const int count = parts_of(radius + distance_mm, edge.sweep);
    Polygon polygon;
    const auto add = [&](int i, double scale) {
      const cutting::Vec out =
          cutting::point_at(edge, static_cast<double>(i) / count) - edge.centre;
      polygon.push_back(edge.centre + out * scale);
    };
    for (int i = 0; i <= count; ++i) add(i, outer);
    for (int i = count; i >= 0 && inner > 0; --i) add(i, inner);
    if (inner == 0) polygon.push_back(edge.centre);
    return polygon;
  }

  Polygon ring(const GEOSGeometry* shape, bool is_outside) const {
    const GEOSCoordSequence* points = GEOSGeom_getCoordSeq_r(geos_.get(), shape);
    unsigned count = 0;
    GEOSCoordSeq_getSize_r(geos_.get(), points, &count);
    Polygon polygon;
    for (unsigned i = 0; i + 1 < count; ++i) {
      cutting::Vec p;
      GEOSCoordSeq_getXY_r(geos_.get(), points, i, &p.x, &p.y);
      polygon.push_back(p);
    }
    if ((area_of(polygon) > 0) != is_outside) std::reverse(polygon.begin(), polygon.end());
    return polygon;
  }

  double chords_;
  std::unique_ptr<GEOSContextHandle_HS, decltype(&GEOS_finish_r)> geos_;
};

}  // namespace lamplock::test
