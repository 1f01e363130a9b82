#include "host/points/weld.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <limits>

#include "host/points/bounds_check.hpp"
#include "tests/points/shapes.hpp"
#include "tests/scale.hpp"

namespace lamplock {
namespace {

using geometry::PointCloud;
using points::weld;
using test::error_of;
using ::testing::HasSubstr;

/// The rule in its simplest form.
PointCloud weld_slowly(const PointCloud& cloud, double d) {
  PointCloud kept;
  for (const auto& p : cloud) {
    bool near = false;
    for (const auto& q : kept) {
      const double x = p.x - q.x, y = p.y - q.y, z = p.z - q.z;
      near = near || x * x + y * y + z * z < d * d;
    }
    if (!near) kept.push_back(p);
  }
  return kept;
}

TEST(Weld, AgreesWithComparingAllPairs) {
  std::mt19937_64 random(9);
  for (int i = 0; i < test::scaled(40); ++i) {
    PointCloud cloud = test::random_cloud(random, 400, 1);
    // Lattice points are exactly at the distance and on the borders of cells.
    if (i % 2 == 0) {
      for (auto& p : cloud) p = {std::round(p.x * 8) / 8, std::round(p.y * 8) / 8, 0};
    }
    const double distance = i % 4 < 2 ? 0.125 : 0.05 + static_cast<double>(i) * 0.01;
    const auto result = weld(cloud, distance);
    EXPECT_EQ(result.points, weld_slowly(cloud, distance));
    EXPECT_EQ(result.points.size() + result.removed, cloud.size());
  }
}

/// Lattices of the distance itself, with duplicates: coordinates near odd multiples of the distance
/// are where the ends of a ball round to cells two apart.
TEST(Weld, AgreesWithComparingAllPairsOnLatticesOfTheDistance) {
  std::mt19937_64 random(11);
  for (int i = 0; i < test::scaled(200); ++i) {
    const double distance = std::ldexp(1 + static_cast<double>(test::below(random, 1000)) / 1000,
                                       -static_cast<int>(test::below(random, 12)));
    const double shift = i % 3 == 0 ? 0 : static_cast<double>(test::below(random, 7)) - 3;
    const auto rank = [&] {
      return static_cast<double>(test::below(random, 24)) - 12 + shift * 1000;
    };
    PointCloud cloud;
    for (int k = 0; k < 150; ++k) {
      cloud.push_back({rank() * distance, rank() * distance, i % 2 == 0 ? 0 : rank() * distance});
      cloud.push_back(cloud[test::below(random, static_cast<std::uint32_t>(cloud.size()))]);
    }
    ASSERT_EQ(weld(cloud, distance).points, weld_slowly(cloud, distance)) << distance;
    ASSERT_EQ(weld(cloud, distance / 3).points, weld_slowly(cloud, distance / 3)) << distance;
  }
}

/// Exact duplicates at every multiple of the distance, on each axis.
TEST(Weld, ExactDuplicatesAreAlwaysFound) {
  for (const double distance : {0.1, 0.09, 0.081, 0.3, 1.0 / 3, 0.13}) {
    for (int k = -3000; k <= 3000; ++k) {
      const double at = k * distance;
      for (const geometry::Point& p :
           {geometry::Point{at, 0, 0}, geometry::Point{0, at, 0}, geometry::Point{0, 0, at}})
        ASSERT_EQ(weld({p, p}, distance).removed, 1u) << k << " x " << distance;
    }
  }
}

TEST(Weld, IsIdempotentAndKeepsTheFirst) {
  rc::check([] {
    PointCloud cloud;
    for (int i = *rc::gen::inRange(1, 100); i > 0; --i) {
      const auto coordinate = [] { return *rc::gen::inRange(-20, 20) * 0.25; };
      cloud.push_back({coordinate(), coordinate(), coordinate()});
    }
    const double distance = *rc::gen::inRange(0, 12) * 0.25;
    const auto once = weld(cloud, distance);
    const auto twice = weld(once.points, distance);
    RC_ASSERT(twice.removed == 0u);
    RC_ASSERT(twice.points == once.points);
    RC_ASSERT(once.points.front() == cloud.front());
  });
}

TEST(Weld, LargeCloudsHaveNoTwoPointsTooClose) {
  std::mt19937_64 random(10);
  const double distance = 0.5;
  auto kept = weld(test::random_cloud(random, 50000, 10), distance).points;
  EXPECT_GT(kept.size(), 10000u);
  std::sort(kept.begin(), kept.end(), [](auto& p, auto& q) { return p.x < q.x; });
  for (std::size_t i = 0; i < kept.size(); ++i) {
    for (std::size_t j = i + 1; j < kept.size() && kept[j].x - kept[i].x < distance; ++j) {
      ASSERT_GE(test::distance(kept[i], kept[j]), distance * (1 - 1e-12));
    }
  }
}

TEST(Weld, WithDistance0KeepsAllPoints) {
  const PointCloud cloud{{1, 1, 1}, {1, 1, 1}};
  EXPECT_EQ(weld(cloud, 0).points, cloud);
  EXPECT_EQ(weld(cloud, 1e-9).points.size(), 1u);
  EXPECT_TRUE(weld({}, 1).points.empty());
  EXPECT_EQ(weld({{1e300, 0, 0}, {-1e300, 0, 0}, {1e300, 0, 0}}, 1e-3).points.size(), 2u);
  EXPECT_NE(error_of([] { weld({}, -1); }), "");
  EXPECT_NE(error_of([] { weld({}, std::numeric_limits<double>::quiet_NaN()); }), "");
}

TEST(Weld, KeepsTheFirstPointsAtAnyDistance) {
  const PointCloud cloud{{0, 0, 0}, {0.1, 0, 0}, {0, 0, 0}, {0.2, 0, 0}, {2, 0, 0}, {2.1, 0, 0}};
  const auto result = weld(cloud, 0.5, 3);
  EXPECT_EQ(result.points, (PointCloud{{0, 0, 0}, {0.1, 0, 0}, {0, 0, 0}, {2, 0, 0}}));
  EXPECT_EQ(result.removed, 2u);
  EXPECT_EQ(weld(cloud, 0.5, 6).points, cloud);
}

TEST(BoundsCheck, NamesTheFirstBadPointAndTheirNumber) {
  const geometry::Bounds space{{-50, -50, -50}, {50, 50, 50}};
  PointCloud cloud{{50 + 5e-7, -50 - 5e-7, 0}, {0, 0, 0}};
  EXPECT_NO_THROW(points::check_bounds(cloud, space, "a.xyz"));
  cloud.push_back({0, 50.5, 0});
  cloud.push_back({0, 0, -51});
  EXPECT_THAT(error_of([&] { points::check_bounds(cloud, space, "a.xyz"); }),
              ::testing::AllOf(HasSubstr("a.xyz"), HasSubstr("2 of 4"), HasSubstr("point 2"),
                               HasSubstr("(0, 50.5, 0)"), HasSubstr("fit x -50..50, y")));
  EXPECT_THAT(error_of([&] { points::check_bounds(cloud, space, "a.xyz", "the block"); }),
              HasSubstr("outside the block"));
  cloud[1].z = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(error_of([&] { points::check_bounds(cloud, space, "a.xyz"); }),
              ::testing::AllOf(HasSubstr("3 of 4"), HasSubstr("point 1"), HasSubstr("nan")));
}

}  // namespace
}  // namespace lamplock
