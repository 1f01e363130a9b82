#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <numbers>

#include "host/geometry/affine.hpp"
#include "host/points/contours.hpp"
#include "host/points/empty_surface.hpp"
#include "host/points/rays.hpp"
#include "host/points/slice.hpp"
#include "tests/points/sampling.hpp"
#include "tests/scale.hpp"

namespace lamplock {
namespace {

using geometry::PointCloud;
using points::Contour;
using points::Planes;
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

TEST(Slice, EqualArcLengthContinuesRoundCorners) {
  const PointCloud square =
      slice(test::box(5, 5, 5), {.layer_mm = 20, .vertex_mm = 0.7, .first_mm = 0});
  ASSERT_EQ(square.size(), 57u);                     // perimeter 40 mm, floor(40 / 0.7)
  const auto along = [](const geometry::Point& p) {  // arc length from the corner (5, -5)
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

// Every contour of a closed body is closed, even if planes contain vertices, edges and flat faces.
TEST(Slice, ContoursOfClosedBodiesAreClosed) {
  std::mt19937_64 random(6);
  for (int i = 0; i < test::scaled(60); ++i) {
    model::Mesh mesh =
        i % 3 == 0   ? test::sphere(4, 3 + test::below(random, 4), 4 + test::below(random, 5))
        : i % 3 == 1 ? test::torus(5, 2, 4 + test::below(random, 8), 4 + test::below(random, 4))
                     : test::box(2, 3, 4);
    // Integer vertices, so that planes at integer heights meet many vertices.
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

TEST(Slice, FlatFacesInPlanesGiveTheirRim) {
  const auto layers =
      by_layer(slice(test::box(5, 5, 5), {.layer_mm = 5, .vertex_mm = 1, .first_mm = -5}));
  ASSERT_EQ(layers.size(), 3u);
  double height = -5;
  for (const auto& [z, points] : layers) {
    EXPECT_EQ(z, height);
    EXPECT_EQ(points.size(), 40u);
    height += 5;
  }
}

// A low box and a high one whose bottom is in a plane through the middle of the low one.
TEST(Slice, EachFlatBottomHasItsRim) {
  model::Mesh both = test::box(5, 5, 5);
  const model::Mesh high = test::box(2, 2, 2);
  const auto first = static_cast<std::uint32_t>(both.vertices.size());
  for (const geometry::Point& p : high.vertices) both.vertices.push_back({p.x + 20, p.y, p.z + 2});
  for (const auto& t : high.triangles)
    both.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  const auto layers = by_layer(slice(both, {.layer_mm = 5, .vertex_mm = 1, .first_mm = -5}));
  ASSERT_EQ(layers.size(), 3u);
  EXPECT_EQ(layers.at(-5).size(), 40u);
  EXPECT_EQ(layers.at(0).size(), 40u + 16u);
  EXPECT_EQ(layers.at(5).size(), 40u);
}

TEST(Slice, TwistMovesTheFirstPointFromLayerToLayer) {
  const model::Mesh mesh = test::box(5, 5, 5);
  const auto start = [&](double twist) {
    std::vector<geometry::Point> first;
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
  // An upright wall of 10 mm: its section is a line.
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

TEST(Slice, OffsetsAreCountedFromTheMesh) {
  model::Mesh mesh = test::sphere(10, 50, 50);
  for (auto& v : mesh.vertices) v.z += 1000;
  const auto layers = by_layer(
      slice(mesh, {.layer_mm = 1, .vertex_mm = 1, .first_offset_mm = 0.5, .last_offset_mm = 5.5}));
  ASSERT_EQ(layers.size(), 15u);
  EXPECT_NEAR(layers.begin()->first, 990.5, 1e-9);
  EXPECT_NEAR(layers.rbegin()->first, 1004.5, 1e-9);
  EXPECT_THAT(error_of([&] { slice(mesh, {.first_mm = 1, .first_offset_mm = 1}); }),
              ::testing::HasSubstr("by offset"));
  EXPECT_NE(error_of([&] { slice(mesh, {.last_mm = 1, .last_offset_mm = 1}); }), "");
}

/// The mesh with its axes exchanged: the z direction becomes `axis`.
model::Mesh lying_along(geometry::Axis axis, model::Mesh mesh) {
  for (auto& v : mesh.vertices) {
    if (axis == geometry::Axis::x) v = {v.z, v.x, v.y};
    if (axis == geometry::Axis::y) v = {v.y, v.z, v.x};
  }
  return mesh;
}

// Slicing a body along an axis equals slicing the upright body and exchanging axes of the points.
TEST(Slice, AlongAnyAxisEqualsTheUprightSlice) {
  const model::Mesh upright = test::torus(10, 3, 40, 20, 0.02);
  const points::SliceOptions options{.layer_mm = 0.5, .vertex_mm = 0.4, .twist_mm = 0.1};
  const PointCloud expected = slice(upright, options);
  for (const geometry::Axis axis : {geometry::Axis::x, geometry::Axis::y}) {
    points::SliceOptions along = options;
    along.frame.axis = axis;
    const PointCloud cloud = slice(lying_along(axis, upright), along);
    model::Mesh laid{expected, {}};
    EXPECT_EQ(cloud, lying_along(axis, laid).vertices);
  }
}

TEST(Slice, InARotatedFrameEqualsTheUprightSlice) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> angle(-180, 180);
  const model::Mesh upright = test::torus(10, 3, 40, 20, 0.02);
  for (int i = 0; i < test::scaled(20); ++i) {
    points::SliceOptions options{.layer_mm = 0.5, .vertex_mm = 0.4};
    // Planes away from the rims, where rounding decides whether there is a contour.
    options.first_offset_mm = 0.251;
    const PointCloud expected = slice(upright, options);
    options.frame = {geometry::Axis::z, angle(random), angle(random), angle(random)};
    const geometry::Affine turn = geometry::turned_about_z(options.frame.turn_z_deg) *
                                  geometry::turned_about_y(options.frame.turn_y_deg) *
                                  geometry::turned_about_x(options.frame.turn_x_deg);
    model::Mesh turned = upright;
    for (auto& v : turned.vertices) v = turn(v);
    const PointCloud cloud = slice(turned, options);
    ASSERT_EQ(cloud.size(), expected.size());
    for (std::size_t k = 0; k < cloud.size(); ++k) {
      EXPECT_LT(test::distance(cloud[k], turn(expected[k])), 1e-6);
    }
  }
}

// Every point of a slice is in one of its planes and on the body, for any frame.
TEST(Slice, RotatedPlanesCutTheSphereInCircles) {
  points::SliceOptions options{.layer_mm = 1, .vertex_mm = 0.3, .first_mm = -9.5};
  options.frame = {geometry::Axis::x, 20, 30, 40};
  const auto cloud = slice(test::sphere(10, 199, 400), options);
  const geometry::Affine turn =
      geometry::turned_about_z(40) * geometry::turned_about_y(30) * geometry::turned_about_x(20);
  const geometry::Point normal = turn({1, 0, 0});
  std::map<long, std::size_t> planes;
  for (const auto& p : cloud) {
    EXPECT_NEAR(std::hypot(p.x, p.y, p.z), 10, 0.01);
    const double height = p.x * normal.x + p.y * normal.y + p.z * normal.z;
    EXPECT_NEAR(height - std::floor(height), 0.5, 1e-9);
    ++planes[std::lround(height - 0.5)];
  }
  EXPECT_EQ(planes.size(), 20u);
}

/// A cylinder round z with `around` sides; its caps are fans round a vertex in the middle.
model::Mesh cylinder(double radius, double half, std::uint32_t around) {
  model::Mesh mesh{{{0, 0, -half}, {0, 0, half}}, {}};
  for (std::uint32_t i = 0; i < around; ++i) {
    const double a = 2 * std::numbers::pi * i / around;
    for (const double z : {-half, half}) {
      mesh.vertices.push_back({radius * std::cos(a), radius * std::sin(a), z});
    }
  }
  for (std::uint32_t i = 0; i < around; ++i) {
    const std::uint32_t low = 2 + 2 * i, next = 2 + 2 * ((i + 1) % around);
    mesh.triangles.insert(
        mesh.triangles.end(),
        {{low, next, next + 1}, {low, next + 1, low + 1}, {0, next, low}, {1, low + 1, next + 1}});
  }
  return mesh;
}

TEST(EmptyShare, OfASlicedCylinderIsThatOfItsCaps) {
  const model::Mesh mesh = cylinder(5, 10, 360);
  ASSERT_TRUE(test::is_closed(mesh));
  const double reach = 0.3;
  // A rim of the reach belongs to the points of the side.
  const double caps = 2 * std::numbers::pi * (5 - reach) * (5 - reach);
  const double all = 2 * std::numbers::pi * 5 * (20 + 5);
  const auto share = [&](const points::SliceOptions& options) {
    return points::empty_share(mesh, slice(mesh, options), reach);
  };
  EXPECT_NEAR(share({.layer_mm = 0.1, .vertex_mm = 0.1}), caps / all, 0.01);
  // Turned enough, all faces are cut.
  EXPECT_EQ(share({.layer_mm = 0.1, .vertex_mm = 0.1, .frame = {.turn_x_deg = 45}}), 0);
}

TEST(EmptyShare, OfABoxUnderRaysIsThatOfItsSides) {
  const model::Mesh mesh = test::box(3, 2, 1);
  const auto cloud = points::rays(mesh, {.pitch_mm = 0.1});
  // The outermost rays are half a pitch from the sides.
  const double sides = 4 * (3 + 2) * (2 - 2 * std::sqrt(0.09 - 0.0025)), all = 8 * (6 + 3 + 2);
  EXPECT_NEAR(points::empty_share(mesh, cloud, 0.3), sides / all, 0.02);
}

/// The whole surface without points, and a part that is as large as wanted.
TEST(EmptyShare, IsTheShareOfTheAreaWithoutPoints) {
  std::mt19937_64 random(8);
  const model::Mesh mesh = test::sphere(10, 39, 80);
  EXPECT_EQ(points::empty_share(mesh, {}, 1), 1);
  EXPECT_EQ(points::empty_share({}, {}, 1), 0);
  EXPECT_EQ(points::empty_share(mesh, test::random_places(mesh, 40'000, random), 0.5), 0);
  for (const double height : {-8.0, 0.0, 5.0, 9.0}) {
    auto cloud = test::random_places(mesh, 40'000, random);
    std::erase_if(cloud, [&](const geometry::Point& p) { return p.z > height; });
    EXPECT_NEAR(points::empty_share(mesh, cloud, 0.5), (10 - height) / 20, 0.04) << height;
  }
}

TEST(Slice, WrongOptionsAreRefused) {
  const model::Mesh mesh = test::box(5, 5, 5);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(error_of([&] { slice(mesh, {.first_mm = nan}); }), "");
  EXPECT_NE(error_of([&] { slice(mesh, {.twist_mm = nan}); }), "");
  EXPECT_NE(error_of([&] { slice(mesh, {.frame = {.turn_y_deg = nan}}); }), "");
  EXPECT_NE(error_of([&] {
              slice(mesh, {.frame = {.turn_x_deg = std::numeric_limits<double>::infinity()}});
            }),
            "");
  EXPECT_NE(error_of([&] { slice(mesh, {.layer_mm = 0}); }), "");
  EXPECT_NE(error_of([&] { slice(mesh, {.vertex_mm = -1}); }), "");
  EXPECT_NE(error_of([&] { slice(mesh, {.layer_mm = 1e-12}); }), "");
  EXPECT_NE(error_of([&] { slice(mesh, {.layer_mm = 1, .vertex_mm = 1e-9}); }), "");
}

}  // namespace
}  // namespace lamplock
