#include "host/order/anneal.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <span>
#include <vector>

#include "host/bench/orders.hpp"
#include "host/order/cone.hpp"
#include "host/order/order.hpp"
#include "host/order/permute.hpp"
#include "host/order/shadow.hpp"
#include "tests/order/clouds.hpp"
#include "tests/scale.hpp"

namespace lamplock {
namespace {

using geometry::PointCloud;
using order::BeatModel;
using order::Indices;
using order::Ordering;

const BeatModel& slow_machine() {
  static const BeatModel model({{2000, 2000, 2000}, {1000, 1000, 1000}, 0.01});
  return model;
}

TEST(Permute, EqualsACopyInThatOrder) {
  std::mt19937_64 random(40);
  for (int i = 0; i < test::scaled(200); ++i) {
    Indices order(random() % 50), things(order.size());
    std::iota(order.begin(), order.end(), 0u);
    std::shuffle(order.begin(), order.end(), random);
    for (std::uint32_t& thing : things) thing = static_cast<std::uint32_t>(random());
    Indices expected;
    for (const std::uint32_t number : order) expected.push_back(things[number]);
    order::permute(std::span(things), order);
    EXPECT_EQ(things, expected);
  }
}

TEST(Anneal, KeepsThePointsAndTheShadowRuleAndWastesNoMore) {
  std::mt19937_64 random(41);
  for (int i = 0; i < test::scaled(30); ++i) {
    const PointCloud cloud = test::awkward_cloud(random, i % test::cloud_kinds, random() % 1500);
    order::OrderOptions options;
    options.layer_mm = 0.3;
    options.half_angle_deg = i % 3 == 0 ? 60 : 20;
    const PointCloud before = order::order(cloud, Ordering::layers, options);
    PointCloud order = before;
    order::anneal(order, slow_machine(), order::cone_tangent(options.half_angle_deg), 10, 2, {});
    EXPECT_TRUE(test::is_permutation_of(order, before)) << i;
    EXPECT_FALSE(order::first_shadowed(order, options.half_angle_deg)) << i;
    EXPECT_LE(slow_machine().beats(order), slow_machine().beats(before)) << i;
  }
}

// Several stretches; each is annealed without the speeds at its ends.
TEST(Anneal, SeamsBetweenStretchesWasteNothing) {
  for (const bench::OrderCloud& cloud :
       bench::order_clouds(std::clamp(test::scaled(15'000), 9'000, 15'000))) {
    order::OrderOptions options;
    options.layer_mm = cloud.layer_mm;
    const PointCloud before = order::order(cloud.points, Ordering::layers, options);
    for (const double asked : {0.02, 1.0}) {
      PointCloud order = before;
      order::anneal(order, slow_machine(), order::cone_tangent(options.half_angle_deg), asked, 2,
                    {});
      EXPECT_TRUE(test::is_permutation_of(order, before)) << cloud.name;
      EXPECT_LE(slow_machine().beats(order), slow_machine().beats(before)) << cloud.name;
    }
  }
}

// Long moves along a line: the speed of the first ones affects beats far after the points that
// stay. The first seeds wasted beats when a stretch was judged by its own estimate.
TEST(Anneal, AnOrderFromRestWastesNoMore) {
  const BeatModel model({{2000, 2000, 2000}, {8000, 8000, 8000}, 0.01});
  std::vector<unsigned> seeds{723, 1663, 1953, 2150};
  for (int i = 0; i < test::scaled(100); ++i) seeds.push_back(static_cast<unsigned>(10'000 + i));
  for (const unsigned seed : seeds) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<> moved(-1, 1);
    PointCloud before;
    for (int i = 0; i < 40; ++i) {
      const double x = 4 * (i + moved(random)), y = 0.4 * moved(random);
      before.push_back({x, y, 0});
    }
    PointCloud order = before;
    order::anneal(order, model, 0.36, 2, 1, {});
    EXPECT_TRUE(test::is_permutation_of(order, before)) << seed;
    EXPECT_LE(model.beats(order), model.beats(before)) << seed;
  }
}

TEST(Anneal, SavesBeatsThatOrderingByLayersWastes) {
  for (const bench::OrderCloud& cloud : bench::order_clouds(3000)) {
    if (cloud.name != "torus" && cloud.name != "solid") continue;
    order::OrderOptions options;
    options.layer_mm = cloud.layer_mm;
    PointCloud order = order::order(cloud.points, Ordering::layers, options);
    const auto wasted = [&] {
      return slow_machine().beats(order) - static_cast<long>(order.size());
    };
    const long before = wasted();
    order::anneal(order, slow_machine(), order::cone_tangent(options.half_angle_deg), 10, 2, {});
    EXPECT_LT(2 * wasted(), before) << cloud.name;
  }
}

TEST(Anneal, DoesNotDependOnThreadsAndReportsProgress) {
  const PointCloud cloud = bench::order_clouds(12'000)[1].points;
  PointCloud alone = order::order(cloud, Ordering::layers), together = alone;
  std::size_t last = 0;
  order::anneal(alone, slow_machine(), 0.36, 1, 1, [&last](std::size_t done) {
    EXPECT_GE(done, last);
    last = done;
  });
  EXPECT_EQ(last, alone.size());
  order::anneal(together, slow_machine(), 0.36, 1, 3, {});
  EXPECT_EQ(alone, together);
}

}  // namespace
}  // namespace lamplock
