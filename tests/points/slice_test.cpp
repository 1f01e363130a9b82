#include <gtest/gtest.h>

#include <map>

#include "host/points/contours.hpp"
#include "host/points/slice.hpp"
#include "tests/points/shapes.hpp"
#include "tests/scale.hpp"

namespace lamplock {
namespace {

using points::Contour;
using points::Planes;
using points::PointCloud;
using points::slice;
using test::error_of;

std::map<double, PointCloud> by_layer(const PointCloud& cloud) {
  std::map<double, PointCloud> layers;
  for (const auto& p : cloud) layers[p.z].push_back(p);
  return layers;
}

/// Signed area of a contour, positive for counter-clockwise.
double area(const PointCloud& v) {
  double sum = 0;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const auto &p = v[i], &q = v[(i + 1) % v.size()];
    sum += (p.x * q.y - q.x * p.y) / 2;
  }
  return sum;
}

TEST(Slice, SphereGivesCirclesOfEvenlySpacedPoints) {
  const auto layers =
      by_layer(slice(test::sphere(10, 199, 400), {.layer_mm = 1, .vertex_mm = 0.5}));
  ASSERT_EQ(layers.size(), 20u);
  double z = -9.5;
  for (const auto& [height, points] : layers) {
    EXPECT_NEAR(height, z, 1e-9);
    z += 1;
    const double radius = std::sqrt(100 - height * height);
    const double length = 2 * std::numbers::pi * radius;
    EXPECT_NEAR(static_cast<double>(points.size()), std::floor(length / 0.5), 1);
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_NEAR(std::hypot(points[i].x, points[i].y), radius, 0.01);
      const double chord = test::distance(points[i], points[(i + 1) % points.size()]);
      EXPECT_NEAR(chord, length / static_cast<double>(points.size()), 0.005);
    }
    EXPECT_GT(area(points), 0);
  }
}

TEST(Slice, TorusGivesTwoCircles) {
  const auto layers =
      by_layer(slice(test::torus(10, 3, 200, 100, 0.01), {.layer_mm = 0.5, .vertex_mm = 0.25}));
  ASSERT_EQ(layers.size(), 12u);
  for (const auto& [z, points] : layers) {
    const double half = std::sqrt(9 - z * z);
    std::size_t outer = 0;
    for (const auto& p : points) {
      const double radius = std::hypot(p.x, p.y);
      EXPECT_NEAR(std::abs(radius - 10), half, 0.03);
      outer += radius > 10 ? 1 : 0;
    }
    const double ratio = static_cast<double>(outer) / static_cast<double>(points.size());
    EXPECT_NEAR(ratio, (10 + half) / 20, 0.01);
  }
}

TEST(Slice, EqualArcLengthGoesRoundCorners) {
  const PointCloud square =
      slice(test::box(5, 5, 5), {.layer_mm = 20, .vertex_mm = 0.7, .first_mm = 0});
  ASSERT_EQ(square.size(), 57u);                   // 40 mm round, floor(40 / 0.7)
  const auto along = [](const points::Point& p) {  // arc length from the corner (5, -5)
    if (p.x > 5 - 1e-9) return p.y + 5;
    if (p.y > 5 - 1e-9) return 10 + 5 - p.x;
    if (p.x < -5 + 1e-9) return 20 + 5 - p.y;
    return 30 + p.x + 5;
  };
  for (std::size_t i = 0; i < square.size(); ++i) {
    const double step = along(square[(i + 1) % square.size()]) - along(square[i]);
    EXPECT_NEAR(step < 0 ? step + 40 : step, 40.0 / 57, 1e-9);
  }
}

// Every contour of a closed body is closed, also when planes go exactly through vertices, edges and
// flat faces.
TEST(Slice, ContoursOfClosedBodiesAreClosed) {
  std::mt19937_64 random(6);
  for (int i = 0; i < test::scaled(60); ++i) {
    model::Mesh mesh =
        i % 3 == 0   ? test::sphere(4, 3 + test::below(random, 4), 4 + test::below(random, 5))
        : i % 3 == 1 ? test::torus(5, 2, 4 + test::below(random, 8), 4 + test::below(random, 4))
                     : test::box(2, 3, 4);
    // Whole-numbered vertices, so that planes at whole numbers meet vertices all the time.
    for (auto& v : mesh.vertices) v = {std::round(v.x), std::round(v.y), std::round(v.z)};
    std::size_t contours = 0;
    points::for_each_plane(mesh, {-5, 0.5, 21}, [&](std::size_t, std::span<const Contour> found) {
      for (const Contour& contour : found) {
        EXPECT_TRUE(contour.closed);
        EXPECT_GE(contour.vertices.size(), 3u);
        ++contours;
      }
    });
    EXPECT_GT(contours, 0u);
  }
}

TEST(Slice, ChainsUseEveryCutOnce) {
  const model::Mesh mesh = test::torus(10, 3, 40, 20, 0.02);
  points::for_each_plane(mesh, {0.3, 1, 2}, [&](std::size_t, std::span<const Contour> found) {
    ASSERT_EQ(found.size(), 2u);
    EXPECT_EQ(found[0].vertices.size() + found[1].vertices.size(), 160u);  // 2 x 40 quads cut twice
  });
}

TEST(Slice, FlatFacesInPlanesGiveTheirRimAtTheTopAndNothingAtTheBottom) {
  const auto layers =
      by_layer(slice(test::box(5, 5, 5), {.layer_mm = 5, .vertex_mm = 1, .first_mm = -5}));
  ASSERT_EQ(layers.size(), 2u);
  EXPECT_EQ(layers.begin()->first, 0);
  EXPECT_EQ(layers.rbegin()->first, 5);
  EXPECT_EQ(layers.rbegin()->second.size(), 40u);
}

TEST(Slice, TwistMovesTheFirstPointFromLayerToLayer) {
  const model::Mesh mesh = test::box(5, 5, 5);
  const auto start = [&](double twist) {
    std::vector<points::Point> first;
    for (const auto& [z, points] : by_layer(
             slice(mesh, {.layer_mm = 1, .vertex_mm = 2, .first_mm = -4, .twist_mm = twist}))) {
      first.push_back(points.front());
    }
    return first;
  };
  const auto straight = start(0), twisted = start(0.5), other_way = start(-0.5);
  ASSERT_EQ(straight.size(), 10u);
  for (std::size_t k = 0; k < 10; ++k) {
    const double offset = std::fmod(0.5 * static_cast<double>(k), 2.0);
    EXPECT_NEAR(std::hypot(twisted[k].x - straight[k].x, twisted[k].y - straight[k].y), offset,
                1e-9);
    const double back = offset > 0 ? 2 - offset : 0;
    EXPECT_NEAR(std::hypot(other_way[k].x - straight[k].x, other_way[k].y - straight[k].y), back,
                1e-9);
  }
}

TEST(Slice, OpenContoursGetTheirEndsOnRequest) {
  // One upright wall of 10 mm: its cut is a line.
  const model::Mesh wall{{{0, 0, 0}, {10, 0, 0}, {10, 0, 4}, {0, 0, 4}}, {{0, 1, 2}, {0, 2, 3}}};
  const auto ends = slice(wall, {.layer_mm = 9, .vertex_mm = 1, .first_mm = 2, .end_points = true});
  ASSERT_EQ(ends.size(), 11u);
  EXPECT_NEAR(test::distance(ends.front(), ends.back()), 10, 1e-9);
  const auto inner = slice(wall, {.layer_mm = 9, .vertex_mm = 1, .first_mm = 2});
  ASSERT_EQ(inner.size(), 10u);
  EXPECT_NEAR(test::distance(inner.front(), inner.back()), 9, 1e-9);
}

TEST(Slice, FirstAndLastBoundThePlanes) {
  const auto layers =
      by_layer(slice(test::sphere(10, 50, 50),
                     {.layer_mm = 0.1, .vertex_mm = 1, .first_mm = -0.3, .last_mm = 0.3}));
  ASSERT_EQ(layers.size(), 7u);
  EXPECT_NEAR(layers.begin()->first, -0.3, 1e-12);
  EXPECT_NEAR(layers.rbegin()->first, 0.3, 1e-12);
  EXPECT_TRUE(slice(test::sphere(10, 9, 9), {.first_mm = 11}).empty());
}

TEST(Slice, WrongOptionsAreRefused) {
  const model::Mesh mesh = test::box(5, 5, 5);
  EXPECT_NE(error_of([&] { slice(mesh, {.layer_mm = 0}); }), "");
  EXPECT_NE(error_of([&] { slice(mesh, {.vertex_mm = -1}); }), "");
  EXPECT_NE(error_of([&] { slice(mesh, {.layer_mm = 1e-12}); }), "");
  EXPECT_NE(error_of([&] { slice(mesh, {.layer_mm = 1, .vertex_mm = 1e-9}); }), "");
}

}  // namespace
}  // namespace lamplock
