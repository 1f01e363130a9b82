#include "host/order/greedy.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "host/order/shadow.hpp"
#include "tests/order/clouds.hpp"
#include "tests/scale.hpp"

namespace lamplock {
namespace {

using geometry::Point;
using geometry::PointCloud;
using order::ConeWeights;

using Cost = std::function<double(const Point& from, const Point& to)>;

/// By definition: the cheapest of the rest, the first of equal ones, without the shadow rule.
std::vector<std::uint32_t> cheapest_of_all(const PointCloud& cloud, Point from, const Cost& cost) {
  std::vector<std::uint32_t> rest(cloud.size()), order;
  for (std::uint32_t i = 0; i < rest.size(); ++i) rest[i] = i;
  while (!rest.empty()) {
    const auto next = std::min_element(rest.begin(), rest.end(), [&](auto a, auto b) {
      return cost(from, cloud[a]) < cost(from, cloud[b]);
    });
    from = cloud[*next];
    order.push_back(*next);
    rest.erase(next);
  }
  return order;
}

Cost cone_cost(const ConeWeights& weights) {
  return [weights](const Point& from, const Point& to) {
    const double dz = to.z - from.z;
    return std::max(std::abs(to.x - from.x), std::abs(to.y - from.y)) +
           (dz > 0 ? weights.up : weights.down) * dz;
  };
}

TEST(Greedy, ConeOrderIsTheDefinition) {
  std::mt19937_64 random(41);
  for (int i = 0; i < test::scaled(150); ++i) {
    const PointCloud cloud = test::awkward_cloud(random, i % test::cloud_kinds, random() % 150);
    std::uniform_real_distribution<double> weight(-2, 2);
    const ConeWeights weights =
        i % 2 == 0 ? ConeWeights{weight(random), weight(random)} : ConeWeights{0.6, 0.3};
    const Point from{weight(random), weight(random), weight(random)};
    EXPECT_EQ(order::cone_first(cloud, from, weights, 0),
              cheapest_of_all(cloud, from, cone_cost(weights)));
  }
}

TEST(Greedy, NearestIsTheNearest) {
  std::mt19937_64 random(42);
  for (int i = 0; i < test::scaled(150); ++i) {
    const PointCloud cloud = test::awkward_cloud(random, i % test::cloud_kinds, random() % 150);
    const auto squared = [](const Point& p, const Point& q) {
      const double x = q.x - p.x, y = q.y - p.y, z = q.z - p.z;
      return x * x + y * y + z * z;
    };
    EXPECT_EQ(order::nearest_first(cloud, {1, 1, 1}, 0),
              cheapest_of_all(cloud, {1, 1, 1}, squared));
  }
}

PointCloud arranged(const PointCloud& cloud, const std::vector<std::uint32_t>& order) {
  PointCloud points;
  for (const std::uint32_t i : order) points.push_back(cloud[i]);
  return points;
}

TEST(Greedy, SteepConesKeepTheRuleWithoutPulling) {
  std::mt19937_64 random(43);
  for (int i = 0; i < test::scaled(40); ++i) {
    const PointCloud cloud = test::random_cloud(random, 1000, 1);
    const double angle = 5 + static_cast<double>(random() % 60);
    const double least = order::cone_tangent(angle);
    const ConeWeights weights{least * (1 + static_cast<double>(random() % 3)), least};
    // Tangent 0: nothing is pulled ahead.
    const auto order = order::cone_first(cloud, {}, weights, 0);
    EXPECT_FALSE(order::first_shadowed(arranged(cloud, order), angle));
    EXPECT_EQ(order::cone_first(cloud, {}, weights, least), order);
  }
}

TEST(Greedy, FlatConesDoNotKeepTheRule) {
  std::mt19937_64 random(44);
  const PointCloud cloud = test::random_cloud(random, 1000, 1);
  const auto order = order::cone_first(cloud, {}, {0.05, 0.05}, 0);
  EXPECT_TRUE(order::first_shadowed(arranged(cloud, order), 20));
  const double tangent = order::cone_tangent(20);
  const auto mended = order::cone_first(cloud, {}, {0.05, 0.05}, tangent);
  EXPECT_FALSE(order::first_shadowed(arranged(cloud, mended), 20));
}

}  // namespace
}  // namespace lamplock
