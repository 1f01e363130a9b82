// Sides that are nearly straight: arcs and splines from a half circle to a deviation far below the
// resolution of a drawing become edges that can be offset and written.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "host/cutting/contour.hpp"
#include "host/cutting/offset.hpp"
#include "host/model/spline.hpp"
#include "tests/cutting/polygon_offset.hpp"
#include "tests/cutting/shapes.hpp"
#include "tests/scale.hpp"

namespace lamplock::cutting::flat_arc_test {
namespace {

using geometry::Random;
using std::numbers::pi;
using namespace lamplock::test;

geometry::Point point(const Vec& at) { return {at.x, at.y, 0}; }

/// Corners in the order of their angle around a centre, anywhere on a sheet.
std::vector<Vec> random_corners(Random& random) {
  const auto count = 3 + random.next() % 6;
  const Vec centre{500 * random.uniform(), 500 * random.uniform()};
  const double size = std::pow(10, 1 + random.uniform());
  std::vector<Vec> corners;
  for (std::size_t i = 0; i < count; ++i) {
    const double turn =
        2 * pi * (static_cast<double>(i) + 0.3 * random.uniform()) / static_cast<double>(count);
    corners.push_back(centre +
                      Vec{std::cos(turn), std::sin(turn)} * size * (0.5 + 0.5 * random.uniform()));
  }
  return corners;
}

/// An arc as readers make it of a bulge.
model::Piece arc_side(const Vec& from, const Vec& to, double bulge) {
  return path_of(bulged(from, to, bulge)).pieces.front();
}

/// A straight side as editors write it: a curve with its poles on the chord, rounded.
model::Piece spline_side(const Vec& from, const Vec& to, double decimal) {
  const auto rounded = [&](const Vec& at) {
    return point({std::round(at.x / decimal) * decimal, std::round(at.y / decimal) * decimal});
  };
  const Vec third = (to - from) * (1.0 / 3);
  return model::bezier({point(from), rounded(from + third), rounded(to - third), point(to)});
}

/// Sides of one kind, or of all kinds; bulges of all sizes.
model::Path random_outline(Random& random, int kind) {
  const std::vector<Vec> corners = random_corners(random);
  model::Path path;
  path.closed = true;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec &from = corners[i], &to = corners[(i + 1) % corners.size()];
    const auto side = kind < 3 ? static_cast<std::uint64_t>(kind) : random.next() % 3;
    const double sign = random.uniform() < 0.5 ? 1 : -1;
    if (side == 0) {
      path.pieces.emplace_back(arc_side(from, to, sign * std::pow(10, -6 * random.uniform()) / 4));
    } else if (side == 1) {
      path.pieces.emplace_back(spline_side(from, to, random.uniform() < 0.5 ? 0.001 : 0.0001));
    } else {
      path.pieces.emplace_back(model::Line{point(from), point(to)});
    }
  }
  return path;
}

Polygon polygon_of(const model::Path& path) {
  Polygon polygon;
  for (const geometry::Point& at : model::flattened(path, 1e-4)) polygon.push_back({at.x, at.y});
  if (polygon.front() == polygon.back()) polygon.pop_back();
  return polygon;
}

TEST(flat_arc, outlines_of_all_sides_are_offset_as_polygons) {
  Random random(41);
  int count = 0;
  for (int i = 0; i < scaled(600, 120); ++i) {
    const model::Path path = random_outline(random, i % 4);
    const JoinedContours joined = join_contours(of_one_layer({path}), {});
    ASSERT_EQ(joined.contours.size(), 1u) << i;
    if (!contour_faults(joined.contours).empty()) continue;
    ++count;
    const double distance_mm = (i % 8 < 4 ? 1 : -1) * (0.005 + 0.2 * random.uniform());
    const OffsetContours moved = offset(joined.contours, {.distance_mm = distance_mm});
    ASSERT_EQ(moved.contours.size(), 1u) << i;
    const std::vector<Polygon> expected = clipper_offset({polygon_of(path)}, distance_mm, 1e-4);
    const std::vector<Polygon> ours = polygons_of(moved.contours, 1e-4);
    EXPECT_LE(furthest(ours, expected), 0.002) << i;
    EXPECT_LE(furthest(expected, ours), 0.002) << i;
  }
  EXPECT_GT(count, 100) << "most outlines do not cross themselves";
}

/// Arcs whose radii the sheet allows are offset exactly, however flat they are beside it.
TEST(flat_arc, an_arc_of_a_kilometre_meets_small_ones) {
  Random random(42);
  for (int i = 0; i < scaled(200, 40); ++i) {
    Contour contour = polygon(random_corners(random));
    for (std::size_t k = 0; k < contour.edges.size(); ++k) {
      Edge& edge = contour.edges[k];
      const double bulge = k % 2 == 0 ? length_of(edge) / (4e6 * (0.1 + 0.9 * random.uniform()))
                                      : 0.01 + 0.1 * random.uniform();
      edge = bulged(edge.from, edge.to, random.uniform() < 0.5 ? bulge : -bulge);
    }
    if (!contour_faults({contour}).empty()) continue;
    for (const double distance_mm : {0.075, -0.075}) {
      const std::vector<Contour> moved = offset({contour}, {.distance_mm = distance_mm}).contours;
      ASSERT_EQ(moved.size(), 1u) << i;
      const auto expected = clipper_offset(polygons_of({contour}, 1e-4), distance_mm, 1e-4);
      EXPECT_LE(furthest(polygons_of(moved, 1e-4), expected), 0.002) << i;
    }
  }
}

TEST(flat_arc, what_deviates_less_than_the_resolution_is_one_line) {
  const auto edges = [](const model::Piece& piece) { return edges_of({{piece}}, 0.001); };
  // The deviation is half the chord times the bulge: 0.00045 mm.
  const std::vector<Edge> flat = edges(arc_side({0, 0}, {90, 5}, 1e-5));
  ASSERT_EQ(flat.size(), 1u);
  EXPECT_TRUE(flat[0].is_line());
  EXPECT_NEAR(distance(flat[0].to, {90, 5}), 0, 1e-6);
  const std::vector<Edge> side = edges(spline_side({20, 26}, {71, 30}, 0.001));
  ASSERT_EQ(side.size(), 1u);
  EXPECT_TRUE(side[0].is_line());
  // Round shapes of any size stay round, arcs of 10 m stay arcs.
  for (const double size : {1e-3, 1e-2, 1.0, 1000.0})
    EXPECT_FALSE(edges(arc_side({0, 0}, {size, 0}, 0.1))[0].is_line()) << size;
  EXPECT_FALSE(edges(arc_side({0, 0}, {100, 0}, 0.0026))[0].is_line());
}

TEST(flat_arc, an_arc_of_a_large_radius_becomes_lines_beside_it) {
  const model::Piece piece = arc_side({-1500, 0}, {1500, 0}, 0.01);
  const std::vector<Edge> edges = edges_of({{piece}}, 0.001);
  EXPECT_GT(edges.size(), 100u);
  EXPECT_LT(edges.size(), 400u);
  const auto& arc = std::get<model::Arc>(piece);
  for (const Edge& edge : edges) {
    ASSERT_TRUE(edge.is_line());
    for (const double part : {0.0, 0.5})
      EXPECT_NEAR(distance(point_at(edge, part), {arc.centre.x, arc.centre.y}), arc.u.x, 0.0006);
  }
  EXPECT_NEAR(distance(edges.back().to, {1500, 0}), 0, 1e-6);
}

}  // namespace
}  // namespace lamplock::cutting::flat_arc_test
