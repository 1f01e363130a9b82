#include "host/order/shadow.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "host/order/order.hpp"
#include "tests/order/clouds.hpp"
#include "tests/scale.hpp"

namespace lamplock {
namespace {

using geometry::Point;
using geometry::PointCloud;
using order::first_shadowed;
using order::Ordering;

/// The rule by its definition, for every pair: the first point that shadows a later one.
std::optional<std::size_t> first_by_pairs(const PointCloud& order, double half_angle_deg) {
  const double tangent = std::tan(half_angle_deg * std::numbers::pi / 180);
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const double below = order[i].z - order[j].z;
      const double off = std::hypot(order[i].x - order[j].x, order[i].y - order[j].y);
      if (below > 0 && off < below * tangent) return i;
    }
  }
  return std::nullopt;
}

TEST(Shadow, EqualsTheSearchOfEveryPair) {
  std::mt19937_64 random(31);
  int found = 0, kept = 0;
  for (int i = 0; i < test::scaled(400); ++i) {
    PointCloud cloud = test::awkward_cloud(random, i % test::cloud_kinds, 1 + random() % 120);
    const double angle = 1 + static_cast<double>(random() % 60);
    // From sorted by height, which keeps the rule, to random order.
    std::sort(cloud.begin(), cloud.end(), [](const Point& p, const Point& q) { return p.z < q.z; });
    for (auto swaps = random() % 4; swaps > 0; --swaps) {
      std::swap(cloud[random() % cloud.size()], cloud[random() % cloud.size()]);
    }
    const auto shadowed = first_shadowed(cloud, angle);
    const auto expected = first_by_pairs(cloud, angle);
    ASSERT_EQ(shadowed.has_value(), expected.has_value()) << i;
    ++(expected ? found : kept);
    if (!expected) continue;
    EXPECT_EQ(shadowed->first, *expected);
    EXPECT_LT(shadowed->first, shadowed->second);
    EXPECT_TRUE(order::shadows(cloud[shadowed->first], cloud[shadowed->second],
                               order::cone_tangent(angle)));
  }
  EXPECT_GT(found, 0);
  EXPECT_GT(kept, 0);
}

TEST(Shadow, ConeOpensDownwardsWithTheHalfAngle) {
  const auto shadowed = [](const Point& first, const Point& second) {
    return first_shadowed(PointCloud{first, second}, 45).has_value();
  };
  EXPECT_TRUE(shadowed({0, 0, 1}, {0, 0, 0}));  // straight below
  EXPECT_TRUE(shadowed({0, 0, 1}, {0.6, -0.6, 0}));
  EXPECT_FALSE(shadowed({0, 0, 1}, {0.8, -0.8, 0}));
  EXPECT_FALSE(shadowed({0, 0, 0}, {0, 0, 1}));  // the lower one first
  EXPECT_FALSE(shadowed({0, 0, 0}, {0, 0, 0}));
  EXPECT_FALSE(shadowed({0, 0, 0}, {1e-9, 0, 0}));  // equal heights
  EXPECT_FALSE(first_shadowed(PointCloud{{0, 0, 1}, {0, 0, 0}}, 0));
}

TEST(Shadow, NothingToShadow) {
  EXPECT_FALSE(first_shadowed(PointCloud{}, 20));
  EXPECT_FALSE(first_shadowed(PointCloud{{1, 2, 3}}, 20));
}

TEST(Shadow, WrongAnglesAndCoordinatesAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double angle : {-1.0, 90.0, 1000.0, nan, std::numeric_limits<double>::infinity()}) {
    EXPECT_NE(test::error_of([&] { first_shadowed(PointCloud{{0, 0, 0}}, angle); }), "") << angle;
  }
  for (const double wrong : {nan, 1e300, -std::numeric_limits<double>::infinity()}) {
    const PointCloud cloud{{0, 0, 0}, {0, wrong, 0}};
    EXPECT_NE(test::error_of([&] { first_shadowed(cloud, 20); }).find("point 1"),
              std::string::npos);
  }
}

TEST(Shadow, PullingAheadRepairsAnyOrder) {
  std::mt19937_64 random(32);
  for (int i = 0; i < test::scaled(200); ++i) {
    const PointCloud cloud = test::awkward_cloud(random, i % test::cloud_kinds, random() % 200);
    const double angle = static_cast<double>(random() % 80);
    PointCloud order = cloud;
    order::pull_ahead(order, order::cone_tangent(angle));
    EXPECT_TRUE(test::is_permutation_of(order, cloud));
    EXPECT_FALSE(first_shadowed(order, angle));
    PointCloud again = order;
    order::pull_ahead(again, order::cone_tangent(angle));
    EXPECT_EQ(again, order);  // an order that keeps the rule is unchanged
  }
}

TEST(Shadow, EveryOrderingKeepsTheRuleOnEveryCloud) {
  std::mt19937_64 random(33);
  for (int i = 0; i < test::scaled(60); ++i) {
    const PointCloud cloud = test::awkward_cloud(random, i % test::cloud_kinds, random() % 400);
    order::OrderOptions options;
    options.layer_mm = i % 2 == 0 ? 0.3 : 5;
    options.half_angle_deg = i % 3 == 0 ? 60 : 20;
    options.cone = i % 2 == 0 ? order::ConeWeights{0.05, -0.1} : order::ConeWeights{};
    for (const Ordering ordering : {Ordering::layers, Ordering::serpentine, Ordering::nearest,
                                    Ordering::cone, Ordering::best}) {
      const PointCloud order = order::order(cloud, ordering, options);
      EXPECT_TRUE(test::is_permutation_of(order, cloud)) << i;
      EXPECT_FALSE(first_shadowed(order, options.half_angle_deg))
          << i << " " << order::ordering_names[static_cast<std::size_t>(ordering)];
    }
  }
}

TEST(Shadow, RoundingToStepsMovesOnlyTheEdgeOfTheCone) {
  std::mt19937_64 random(34);
  constexpr double steps_per_mm = 200;
  constexpr double edge_mm = 0.01;  // two points off by half a step in each coordinate
  const auto rounded = [](double mm) { return std::round(mm * steps_per_mm) / steps_per_mm; };
  const double tangent = order::cone_tangent(order::default_half_angle_deg);
  const PointCloud cloud = test::random_cloud(random, 1500, 0.5);
  for (const Ordering ordering : {Ordering::layers, Ordering::nearest, Ordering::best}) {
    PointCloud order = order::order(cloud, ordering, {.layer_mm = 0.08});
    for (Point& p : order) p = {rounded(p.x), rounded(p.y), rounded(p.z)};
    for (std::size_t i = 0; i < order.size(); ++i) {
      for (std::size_t j = i + 1; j < order.size(); ++j) {
        const double below = order[i].z - order[j].z;
        const double off = std::hypot(order[i].x - order[j].x, order[i].y - order[j].y);
        ASSERT_GE(off, below * tangent - edge_mm);
      }
    }
  }
}

}  // namespace
}  // namespace lamplock
