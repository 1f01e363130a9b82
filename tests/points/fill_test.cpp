#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "host/points/fill_faces.hpp"
#include "host/points/fill_solid.hpp"
#include "tests/points/sampling.hpp"
#include "tests/scale.hpp"

namespace lamplock {
namespace {

using geometry::PointCloud;
using model::Mesh;
using points::fill_faces;
using points::fill_solid;
using test::error_of;
using ::testing::HasSubstr;

TEST(FillFaces, AnEquilateralTriangleTakesTheTriangularNumber) {
  Mesh mesh;
  for (const double side : {1.0, 2.0, 5.0, 20.0}) {
    mesh.vertices = {{0, 0, 0}, {side, 0, 0}, {side / 2, side * std::numbers::sqrt3 / 2, 0}};
    mesh.triangles = {{0, 1, 2}};
    // Slightly less than the side's part, because points are never closer than requested.
    const auto fill = fill_faces(mesh, {.distance_mm = 1 - 1e-6});
    const auto n = static_cast<std::size_t>(side);
    EXPECT_EQ(fill.points.size(), (n + 1) * (n + 2) / 2);
    EXPECT_EQ(fill.rejected, 0u);
    EXPECT_EQ(fill.welded, 0u);
  }
}

TEST(FillFaces, SharedEdgesAreNotFilledTwice) {
  std::mt19937_64 random(1);
  for (int i = 0; i < test::scaled(20); ++i) {
    const double distance = 0.1 + static_cast<double>(test::below(random, 100)) / 200;
    const auto fill = fill_faces(test::box(3, 2, 1), {.distance_mm = distance});
    EXPECT_GE(test::min_square(fill.points), distance * distance * (1 - 1e-12));
    EXPECT_GT(fill.welded, 0u);
  }
}

TEST(FillFaces, ABoxTakesAboutTheDensestArrangement) {
  const double distance = 0.1, area = 2 * (6 * 4 + 6 * 2 + 4 * 2);
  const auto fill = fill_faces(test::box(3, 2, 1), {.distance_mm = distance});
  // sqrt(3) / 2 square distances a point; rows end where triangles meet.
  const double densest = area / (distance * distance * std::numbers::sqrt3 / 2);
  EXPECT_NEAR(static_cast<double>(fill.points.size()) / densest, 1, 0.05);
}

TEST(FillFaces, TheCommonLongestSideHasOneRowOfPoints) {
  Mesh mesh;
  test::add_plate(mesh, 0, 0, 4, 4, 1, 1);
  const auto fill = fill_faces(mesh, {.distance_mm = 0.5});
  int on_diagonal = 0;
  for (const auto& p : fill.points) on_diagonal += std::abs(p.x - p.y) < 1e-9 ? 1 : 0;
  EXPECT_EQ(on_diagonal, 12);  // 4 * sqrt(2) / 0.5 = 11.3
  // Both rows begin at the same end, so one triangle is the mirror image of the other.
  for (const auto& p : fill.points) {
    EXPECT_LT(test::nearest_distance({p.y, p.x, 0}, fill.points), 1e-9);
  }
}

TEST(FillFaces, EveryPlaceIsNearAPoint) {
  std::mt19937_64 random(2);
  const Mesh mesh = test::sphere(5, 9, 18);
  const auto fill = fill_faces(mesh, {.distance_mm = 0.3});
  for (const auto& place : test::random_places(mesh, test::scaled(500), random)) {
    EXPECT_LT(test::nearest_distance(place, fill.points), 2 * 0.3);
  }
}

/// A plate of one piece and of pieces far smaller than the distance.
TEST(FillFaces, APlateHasOneDensityForAnyTriangles) {
  const double densest = 20 * 10 / (0.2 * 0.2 * std::numbers::sqrt3 / 2);
  for (const std::uint32_t pieces : {1u, 7u, 100u, 300u}) {
    Mesh mesh;
    test::add_plate(mesh, 0, 0, 20, 10, pieces, pieces);
    const auto fill = fill_faces(mesh, {.distance_mm = 0.2});
    EXPECT_NEAR(static_cast<double>(fill.points.size()) / densest, 1, 0.03) << pieces;
    EXPECT_EQ(fill.rejected, 0u);
  }
}

TEST(FillFaces, ABallHasOneDensityForAnyTriangles) {
  std::mt19937_64 random(4);
  const auto density = [](const Mesh& mesh, const points::FaceFill& fill) {
    return static_cast<double>(fill.points.size()) / test::area(mesh);
  };
  const Mesh coarse = test::sphere(5, 19, 40);
  const double wanted = density(coarse, fill_faces(coarse, {.distance_mm = 0.15}));
  for (const auto& [rings, around] : {std::pair{59u, 120u}, {199u, 400u}}) {
    const Mesh fine = test::sphere(5, rings, around);
    const auto fill = fill_faces(fine, {.distance_mm = 0.15});
    EXPECT_NEAR(density(fine, fill) / wanted, 1, 0.06) << rings;
    EXPECT_GE(test::min_square(fill.points), 0.15 * 0.15);
    for (const auto& place : test::random_places(fine, test::scaled(200), random))
      EXPECT_LT(test::nearest_distance(place, fill.points), 2 * 0.15);
  }
}

TEST(FillFaces, TurnedTrianglesAreFilledAsTheOthers) {
  std::mt19937_64 random(5);
  Mesh mesh = test::sphere(2, 30, 60);
  const auto points = fill_faces(mesh, {.distance_mm = 0.2}).points;
  for (auto& triangle : mesh.triangles)
    if (random() % 2 == 0) std::swap(triangle[1], triangle[2]);
  EXPECT_EQ(fill_faces(mesh, {.distance_mm = 0.2}).points.size(), points.size());
}

TEST(FillFaces, TrianglesBelowTheSmallestSideAreRejectedAndCounted) {
  const Mesh mesh = test::sphere(1, 99, 200);  // sides of 0.03 and less
  const auto none = fill_faces(mesh, {.distance_mm = 0.1, .min_side_mm = 0.1});
  EXPECT_EQ(none.rejected, mesh.triangles.size());
  EXPECT_TRUE(none.points.empty());
  const auto all = fill_faces(mesh, {.distance_mm = 0.1});
  EXPECT_EQ(all.rejected, 0u);
  EXPECT_GT(all.points.size(), 900u);
}

TEST(FillFaces, WrongInputIsRefused) {
  Mesh mesh = test::box(1, 1, 1);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(error_of([&] { fill_faces(mesh, {.distance_mm = 0}); }), "");
  EXPECT_NE(error_of([&] { fill_faces(mesh, {.min_side_mm = -1}); }), "");
  EXPECT_NE(error_of([&] { fill_faces(mesh, {.distance_mm = 1e-5}); }), "");
  EXPECT_NE(error_of([&] { fill_faces(test::box(1e200, 1e200, 1e200), {}); }), "");
  mesh.vertices[7].z = nan;
  EXPECT_THAT(error_of([&] { fill_faces(mesh, {}); }), HasSubstr("vertex 7"));
  EXPECT_TRUE(fill_faces({}, {}).points.empty());
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  mesh.triangles = {{0, 1, 2}};
  EXPECT_EQ(fill_faces(mesh, {.distance_mm = 0.1}).rejected, 1u);
}

/// A ball with a spherical hole: its surface is oriented the other way. The whole may be inside
/// out.
Mesh hollow_ball(bool inside_out) {
  Mesh mesh = test::sphere(5, 40, 80);
  const Mesh hole = test::sphere(3, 40, 80);
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), hole.vertices.begin(), hole.vertices.end());
  for (const auto& [a, b, c] : hole.triangles) {
    mesh.triangles.push_back({first + a, first + c, first + b});
  }
  if (inside_out)
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

TEST(FillSolid, PointsAreInsideAndApart) {
  for (const bool inside_out : {false, true}) {
    const PointCloud cloud = fill_solid(hollow_ball(inside_out), {.distance_mm = 0.5});
    EXPECT_GE(test::min_square(cloud), 0.25);
    for (const auto& p : cloud) {
      const double r = std::hypot(p.x, p.y, p.z);
      EXPECT_LT(r, 5);
      EXPECT_GT(r, 2.98);  // the mesh of the hole lies inside its ball
    }
    // More than inside a large body, because the skin has a higher density.
    const double volume = 4.0 / 3 * std::numbers::pi * (125 - 27);
    EXPECT_NEAR(static_cast<double>(cloud.size()) * 0.125 / volume, 0.71, 0.04);
  }
}

TEST(FillSolid, EveryPlaceInsideIsNearAPoint) {
  std::mt19937_64 random(3);
  const PointCloud cloud = fill_solid(test::box(3, 3, 3), {.distance_mm = 0.5});
  for (const auto& place :
       test::random_cloud(random, static_cast<std::size_t>(test::scaled(1000)), 3)) {
    EXPECT_LT(test::nearest_distance(place, cloud), 1.45 * 0.5);
  }
}

/// A ray along its axis goes through both poles, for any numbering of their vertices.
TEST(FillSolid, IsFilledAlongTheAxisOfABall) {
  for (const bool reversed : {false, true}) {
    model::Mesh mesh = test::sphere(8, 15, 24);
    if (reversed) {
      const auto last = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
      std::reverse(mesh.vertices.begin(), mesh.vertices.end());
      for (auto& triangle : mesh.triangles)
        for (auto& corner : triangle) corner = last - corner;
    }
    // Middles of blocks of 16 distances, and of cells, are on the axis.
    for (const double distance : {1.0, 0.8, 0.5}) {
      const PointCloud cloud = fill_solid(mesh, {.distance_mm = distance});
      for (const double z : {-6.0, -3.0, 0.0, 3.0, 6.0})
        EXPECT_LT(test::nearest_distance({0, 0, z}, cloud), 1.45 * distance) << z;
    }
  }
}

TEST(FillSolid, CountGrowsWithTheInverseCube) {
  for (const double distance : {0.8, 0.4, 0.2}) {
    const PointCloud cloud = fill_solid(test::box(2, 2, 2), {.distance_mm = distance});
    // In a skin thinner than a distance the density is higher than inside.
    const double part = static_cast<double>(cloud.size()) * std::pow(distance, 3) / 64;
    EXPECT_GT(part, 0.63);
    EXPECT_LT(part, 0.65 + 0.3 * distance);
  }
}

TEST(FillSolid, DensityDecreasesWithTheVolumeAbove) {
  const points::SolidOptions options{.distance_mm = 0.25, .light_depth_mm = 3, .min_density = 0.02};
  const PointCloud cloud = fill_solid(test::box(4, 4, 4), options);
  EXPECT_GE(test::min_square(cloud), 0.0625);
  std::array<double, 4> slabs{};  // two mm each, from the top
  for (const auto& p : cloud) ++slabs[static_cast<std::size_t>((4 - p.z) / 2) % 4];
  for (std::size_t i = 1; i < slabs.size(); ++i) {
    EXPECT_NEAR(slabs[i] / slabs[i - 1], std::exp(-2.0 / 3), 0.06) << i;
  }
  // Under a gap, the light has only passed through filled volume.
  Mesh two = test::box(2, 2, 1);
  const Mesh upper = test::box(2, 2, 1);
  for (auto p : upper.vertices) two.vertices.push_back({p.x, p.y, p.z + 10});
  for (const auto& [a, b, c] : upper.triangles) two.triangles.push_back({a + 8, b + 8, c + 8});
  std::array<double, 2> bodies{};
  for (const auto& p : fill_solid(two, options)) ++bodies[p.z > 5 ? 0 : 1];
  EXPECT_NEAR(bodies[1] / bodies[0], std::exp(-2.0 / 3), 0.06);
}

/// With light of less than an eighth, the distance is so large that no cell is divided.
TEST(FillSolid, EveryDarkPlaceIsNearAPoint) {
  const points::SolidOptions options{.distance_mm = 0.4, .light_depth_mm = 1, .min_density = 0.06};
  constexpr double half_mm = 5;
  const PointCloud cloud = fill_solid(test::box(half_mm, half_mm, half_mm), options);
  const double distance = options.distance_mm / std::cbrt(options.min_density);
  std::mt19937_64 random(4);
  for (auto place :
       test::random_cloud(random, static_cast<std::size_t>(test::scaled(2000)), half_mm)) {
    place.z = (place.z - half_mm) / 2;  // in the lower half
    EXPECT_LT(test::nearest_distance(place, cloud), 1.1 * distance);
  }
}

TEST(FillSolid, TheSameForAnyNumberOfThreads) {
  const Mesh mesh = test::torus(6, 2, 30, 20);
  const PointCloud one = fill_solid(mesh, {.distance_mm = 0.4, .seed = 3, .threads = 1});
  for (const unsigned threads : {0u, 2u, 5u}) {
    EXPECT_EQ(fill_solid(mesh, {.distance_mm = 0.4, .seed = 3, .threads = threads}), one);
  }
  EXPECT_NE(fill_solid(mesh, {.distance_mm = 0.4, .seed = 4, .threads = 1}), one);
}

TEST(FillSolid, OpenAndWrongInputIsRefused) {
  Mesh mesh = test::box(1, 1, 1);
  mesh.triangles.pop_back();
  EXPECT_THAT(error_of([&] { fill_solid(mesh, {}); }),
              ::testing::AllOf(HasSubstr("not closed"), HasSubstr("3 open edges")));
  mesh = test::box(1, 1, 1);
  for (const points::SolidOptions& options :
       {points::SolidOptions{.distance_mm = 0}, points::SolidOptions{.distance_mm = 1e-3},
        points::SolidOptions{.distance_mm = 1e-12}, points::SolidOptions{.light_depth_mm = -1},
        points::SolidOptions{.min_density = 0}, points::SolidOptions{.min_density = 2}}) {
    EXPECT_NE(error_of([&] { fill_solid(mesh, options); }), "");
  }
  for (auto& vertex : mesh.vertices) vertex.z += 1e8;
  EXPECT_THAT(error_of([&] { fill_solid(mesh, {.distance_mm = 0.5}); }),
              HasSubstr("1e+08 mm from the origin is too far away"));
  mesh.vertices[0].x = std::numeric_limits<double>::infinity();
  EXPECT_THAT(error_of([&] { fill_solid(mesh, {}); }), HasSubstr("vertex 0"));
  EXPECT_TRUE(fill_solid({}, {}).empty());
}

}  // namespace
}  // namespace lamplock
