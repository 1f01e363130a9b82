#include "host/points/shells.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "host/points/blue_noise.hpp"
#include "tests/points/sampling.hpp"
#include "tests/scale.hpp"

namespace lamplock {
namespace {

using geometry::Point;
using geometry::PointCloud;
using points::compensate_depth;
using points::inward_ways;
using points::spread_over_shells;
using test::error_of;
using ::testing::HasSubstr;

PointCloud square_grid(int side, double distance) {
  PointCloud cloud;
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) cloud.push_back({i * distance, j * distance, 0});
  }
  return cloud;
}

TEST(Shells, NeighboursOnAGridAreOnDifferentShells) {
  const PointCloud cloud = square_grid(20, 1);
  const auto shells = spread_over_shells(cloud, {}, {.shells = 3, .shell_mm = 1, .distance_mm = 1});
  EXPECT_EQ(shells.removed, 0u);
  ASSERT_EQ(shells.points.size(), cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_EQ(shells.points[i], (Point{cloud[i].x, cloud[i].y, -1.0 * shells.shell[i]}));
    for (std::size_t j = 0; j < i; ++j) {
      if (test::distance(cloud[i], cloud[j]) < 1.1) {
        EXPECT_NE(shells.shell[i], shells.shell[j]);
      }
    }
  }
  // Three shells with about equal numbers of points.
  for (int shell = 0; shell < 3; ++shell) {
    EXPECT_NEAR(static_cast<double>(std::count(shells.shell.begin(), shells.shell.end(), shell)),
                400 / 3.0, 30);
  }
}

/// Points of a lattice of half the distance, each of them twice: coordinates near odd multiples of
/// the reach are where rounding puts the ends of a search two cells apart.
TEST(Shells, NeverTooCloseOnLatticesOfTheDistance) {
  std::mt19937_64 random(5);
  for (int i = 0; i < test::scaled(40); ++i) {
    const double distance = 0.05 + static_cast<double>(test::below(random, 1000)) / 4000;
    PointCloud cloud;
    for (int k = -25; k <= 25; ++k) {
      for (int l = 0; l < 3; ++l) {
        cloud.push_back({k * distance, l * 4 * distance, k * distance / 2});
        cloud.push_back(cloud.back());
      }
    }
    const auto shells = spread_over_shells(
        cloud, {}, {.shells = 2, .shell_mm = distance * 2, .distance_mm = distance});
    ASSERT_GE(test::min_square(shells.points), distance * distance) << distance;
  }
}

/// Pairs closer than 1.2 distances on one shell.
std::size_t near_pairs(const PointCloud& cloud, const std::vector<std::uint8_t>& shell,
                       double distance) {
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (shell[i] == shell[j] && test::distance(cloud[i], cloud[j]) < 1.2 * distance) ++pairs;
    }
  }
  return pairs;
}

TEST(Shells, OfASphereSeparateNeighbours) {
  const double distance = 0.4;
  const auto mesh = test::sphere(5, 60, 120);
  const PointCloud cloud = points::blue_noise(mesh, {.distance_mm = distance});
  const auto inward = inward_ways(mesh, cloud, 0.1);
  const auto together =
      static_cast<double>(near_pairs(cloud, std::vector<std::uint8_t>(cloud.size(), 0), distance));
  // With random shells, a third and a fifth of the pairs would be on the same shell.
  for (const auto& [count, most] : {std::pair{3, 0.15}, std::pair{5, 0.03}}) {
    const auto shells = spread_over_shells(
        cloud, inward, {.shells = count, .shell_mm = 0.1, .distance_mm = distance});
    EXPECT_GE(test::min_square(shells.points), distance * distance);
    EXPECT_EQ(shells.points.size() + shells.removed, cloud.size());
    EXPECT_LT(static_cast<double>(shells.removed) / static_cast<double>(cloud.size()), 0.01);
    for (std::size_t i = 0; i < shells.points.size(); ++i) {
      const auto& p = shells.points[i];
      EXPECT_NEAR(std::hypot(p.x, p.y, p.z), 5 - 0.1 * shells.shell[i], 0.02);
    }
    EXPECT_LT(static_cast<double>(near_pairs(shells.points, shells.shell, distance)),
              most * together);
  }
}

TEST(Shells, OneShellKeepsPointsThatAreApart) {
  const PointCloud cloud{{0, 0, 0}, {0.5, 0, 0}, {1, 0, 0}, {1, 0, 0}};
  const auto shells = spread_over_shells(cloud, {}, {.shells = 1, .shell_mm = 0, .distance_mm = 1});
  EXPECT_EQ(shells.points, (PointCloud{{0, 0, 0}, {1, 0, 0}}));
  EXPECT_EQ(shells.removed, 2u);
}

TEST(Shells, RandomCloudsAreApartAfterwards) {
  std::mt19937_64 random(1);
  for (int i = 0; i < test::scaled(20); ++i) {
    const PointCloud cloud = test::random_cloud(random, 500, 2);
    const points::ShellOptions options{.shells = 1 + static_cast<int>(test::below(random, 6)),
                                       .shell_mm = 0.05 + 0.1 * test::below(random, 5),
                                       .distance_mm = 0.1 + 0.1 * test::below(random, 4)};
    PointCloud inward = test::random_cloud(random, 500, 1);
    const auto shells = spread_over_shells(cloud, inward, options);
    EXPECT_GE(test::min_square(shells.points), options.distance_mm * options.distance_mm);
    EXPECT_EQ(shells.points.size() + shells.removed, cloud.size());
    EXPECT_EQ(shells.points.size(), shells.shell.size());
  }
}

TEST(InwardWays, OfASpherePointToItsCentre) {
  std::mt19937_64 random(2);
  const auto mesh = test::sphere(5, 200, 400);
  const PointCloud cloud = test::random_places(mesh, 500, random);
  const auto ways = inward_ways(mesh, cloud, 0.01);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto& p = cloud[i];
    EXPECT_NEAR((ways[i].x * p.x + ways[i].y * p.y + ways[i].z * p.z) / 5, -1, 1e-3);
  }
}

TEST(InwardWays, TheNearestTriangleWithinReachCounts) {
  const auto mesh = test::box(1, 2, 3);
  const PointCloud cloud{{1.2, 0, 0}, {0, -2.3, 1}, {0.2, 0.3, 2.9}, {9, 0, 0}, {0, 0, -3}};
  const auto ways = inward_ways(mesh, cloud, 0.5);
  EXPECT_EQ(ways, (std::vector<Point>{{-1, 0, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, -1}, {0, 0, 1}}));
  // In the plane of a triangle, but outside it.
  model::Mesh two;
  two.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2, 1, 0}, {0.2, 2, 0}, {0.2, 1, 1}};
  two.triangles = {{0, 1, 2}, {3, 4, 5}};
  EXPECT_EQ(inward_ways(two, PointCloud{{0.2, 0.2, 0.3}}, 0.5).front(), (Point{0, 0, -1}));
  two.triangles[0] = {0, 2, 1};
  EXPECT_EQ(inward_ways(two, PointCloud{{0.2, 0.2, 0.3}}, 0.5).front(), (Point{0, 0, 1}));
  EXPECT_EQ(inward_ways({}, cloud, 1).size(), cloud.size());
  EXPECT_NE(error_of([&] { inward_ways(mesh, cloud, 0); }), "");
}

TEST(Shells, WrongInputIsRefused) {
  const PointCloud cloud{{0, 0, 0}};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const points::ShellOptions& options :
       {points::ShellOptions{.shells = 0}, points::ShellOptions{.shells = 256},
        points::ShellOptions{.shell_mm = 0}, points::ShellOptions{.distance_mm = nan}}) {
    EXPECT_NE(error_of([&] { spread_over_shells(cloud, {}, options); }), "");
  }
  const PointCloud two{{0, 0, 1}, {0, 0, 1}};
  EXPECT_NE(error_of([&] { spread_over_shells(cloud, two, {}); }), "");
  EXPECT_THAT(error_of([&] {
                spread_over_shells(PointCloud{{0, 0, nan}}, {}, {});
              }),
              HasSubstr("point 0"));
  EXPECT_TRUE(spread_over_shells({}, {}, {}).points.empty());
}

TEST(DepthCompensation, DensityChangesLinearlyWithDepth) {
  std::mt19937_64 random(3);
  PointCloud cloud = test::random_cloud(random, 100'000, 10);  // z from -10 to 10
  const points::DepthOptions options{
      .entry_z_mm = 10, .full_depth_mm = 10, .density_at_face = 0.2, .density_at_depth = 0.8};
  const PointCloud kept = compensate_depth(cloud, options);
  std::array<double, 4> all{}, left{};  // slabs of 5 mm from the face
  const auto slab = [](const Point& p) { return static_cast<std::size_t>((10 - p.z) / 5) % 4; };
  for (const auto& p : cloud) ++all[slab(p)];
  for (const auto& p : kept) ++left[slab(p)];
  const std::array<double, 4> expected{0.35, 0.65, 0.8, 0.8};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(left[i] / all[i], expected[i], 0.015);
  EXPECT_EQ(compensate_depth(cloud, options), kept);
  EXPECT_EQ(compensate_depth(cloud, {.density_at_face = 1}).size(), cloud.size());
  EXPECT_NE(error_of([&] { compensate_depth(cloud, {.full_depth_mm = 0}); }), "");
  EXPECT_NE(error_of([&] { compensate_depth(cloud, {.density_at_face = 1.5}); }), "");
}

}  // namespace
}  // namespace lamplock
