#include "host/order/order.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <array>
#include <limits>

#include "host/bench/orders.hpp"
#include "host/order/cost.hpp"
#include "host/points/slice.hpp"
#include "tests/order/clouds.hpp"
#include "tests/scale.hpp"

namespace lamplock {
namespace {

using geometry::Point;
using geometry::PointCloud;
using order::Ordering;
using order::OrderOptions;
using test::error_of;
using test::is_permutation_of;

double travel(const PointCloud& cloud) {
  double sum = 0;
  for (std::size_t i = 1; i < cloud.size(); ++i) sum += test::distance(cloud[i - 1], cloud[i]);
  return sum;
}

double unevenness(const PointCloud& cloud) {
  double sum = 0;
  for (std::size_t i = 2; i < cloud.size(); ++i) {
    sum += order::bend(cloud[i - 2], cloud[i - 1], cloud[i]);
  }
  return sum;
}

/// Alternating rows in strips of the best width for random points, sqrt(3 area / n).
PointCloud serpentine(PointCloud cloud, double side) {
  const double strip = std::sqrt(3 * side * side / static_cast<double>(cloud.size()));
  const auto key = [&](const Point& p) {
    const double row = std::floor(p.y / strip);
    return std::pair(row, std::fmod(std::abs(row), 2) < 1 ? p.x : -p.x);
  };
  std::sort(cloud.begin(), cloud.end(),
            [&](const Point& p, const Point& q) { return key(p) < key(q); });
  return cloud;
}

TEST(Order, IsAPermutationWithLayersAscending) {
  std::mt19937_64 random(11);
  for (int i = 0; i < test::scaled(30); ++i) {
    PointCloud cloud = test::random_cloud(random, 1 + random() % 2000, 5);
    if (i % 3 == 0) {  // many equal points, lattices and tiny layers
      for (auto& p : cloud) p = {std::round(p.x), std::round(p.y), std::round(p.z * 4) / 4};
    }
    OrderOptions options;
    options.layer_mm = i % 2 == 0 ? 0.25 : 100;
    const PointCloud ordered = order::order(cloud, Ordering::layers, options);
    EXPECT_TRUE(is_permutation_of(cloud, ordered));
    double lowest = ordered[0].z;
    for (const Point& p : cloud) lowest = std::min(lowest, p.z);
    double layer = 0;
    for (const Point& p : ordered) {
      const double now = std::floor((p.z - lowest) / options.layer_mm + 1e-6);
      EXPECT_GE(now, layer);
      layer = now;
    }
  }
}

TEST(Order, SmallCloudsOfEverySizeAreComplete) {
  rc::check([] {
    PointCloud cloud;
    for (int i = *rc::gen::inRange(0, 14); i > 0; --i) {
      cloud.push_back({static_cast<double>(*rc::gen::inRange(-3, 3)),
                       static_cast<double>(*rc::gen::inRange(-3, 3)),
                       static_cast<double>(*rc::gen::inRange(0, 2))});
    }
    const auto ordered = order::order(cloud, Ordering::layers, {.layer_mm = 0.5});
    RC_ASSERT(is_permutation_of(cloud, ordered));
  });
}

TEST(Order, GivenKeepsTheOrder) {
  std::mt19937_64 random(12);
  const PointCloud cloud = test::random_cloud(random, 3000, 50);
  EXPECT_EQ(order::order(cloud, Ordering::given), cloud);
}

TEST(Order, TourOfRandomPointsIsMuchShorterThanASerpentine) {
  std::mt19937_64 random(13);
  for (int i = 0; i < test::scaled(5); ++i) {
    PointCloud cloud = test::random_cloud(random, 2000 + random() % 4000, 10);
    for (Point& p : cloud) p.z = 0;
    const auto ordered = order::order(cloud, Ordering::layers, {.start = cloud.front()});
    EXPECT_LT(travel(ordered), 0.95 * travel(serpentine(cloud, 20)));
  }
}

TEST(Order, LatticesAreWalkedRowByRow) {
  PointCloud cloud;
  for (int layer = 0; layer < 3; ++layer) {
    for (int i = 0; i < 40; ++i) {
      for (int j = 0; j < 25; ++j) cloud.push_back({i * 0.1, j * 0.1, layer * 0.1});
    }
  }
  std::shuffle(cloud.begin(), cloud.end(), std::mt19937_64(14));
  const auto ordered = order::order(cloud, Ordering::layers, {.layer_mm = 0.1});
  EXPECT_NEAR(travel(ordered), 0.1 * 2999, 1e-6);  // no step longer than the lattice
  // 24 reversals of two bends a layer, and two changes of layer: nothing else is uneven.
  EXPECT_LT(unevenness(ordered),
            order::bend_weight * 0.1 * std::sqrt(2.0) * (3 * 24 * 2 + 4) + 1e-6);
}

TEST(Order, FollowsContours) {
  points::SliceOptions options;
  options.layer_mm = 1;
  options.vertex_mm = 0.25;
  PointCloud cloud = points::slice(test::torus(10, 3, 200, 100, 0.01), options);
  const double contours = travel(cloud);
  std::shuffle(cloud.begin(), cloud.end(), std::mt19937_64(15));
  const auto ordered = order::order(cloud, Ordering::layers, {.layer_mm = 1});
  EXPECT_LT(travel(ordered), 1.2 * contours);
  std::size_t off_contour = 0;
  for (std::size_t i = 1; i < ordered.size(); ++i) {
    off_contour += test::distance(ordered[i], ordered[i - 1]) > 0.26 ? 1u : 0u;
  }
  EXPECT_LT(static_cast<double>(off_contour), 0.1 * static_cast<double>(ordered.size()));
}

TEST(Order, LayersAreJoinedWithoutLongJumps) {
  PointCloud cloud = points::slice(test::sphere(10, 60, 120), {.layer_mm = 0.5, .vertex_mm = 0.25});
  const auto ordered = order::order(cloud, Ordering::layers, {.layer_mm = 0.5});
  for (std::size_t i = 1; i < ordered.size(); ++i) {
    if (ordered[i].z == ordered[i - 1].z) continue;
    EXPECT_LT(test::distance(ordered[i], ordered[i - 1]), 2.5);
  }
}

constexpr std::array all_orderings{Ordering::given,   Ordering::layers, Ordering::serpentine,
                                   Ordering::nearest, Ordering::cone,   Ordering::best};

TEST(Order, DoesNotDependOnThreads) {
  std::mt19937_64 random(16);
  const PointCloud cloud = test::random_cloud(
      random, static_cast<std::size_t>(std::clamp(test::scaled(3000), 1000, 3000)), 3);
  for (const Ordering ordering : all_orderings) {
    const auto with = [&](unsigned threads) {
      return order::order(cloud, ordering, {.layer_mm = 0.5, .threads = threads});
    };
    const auto one = with(1);
    EXPECT_EQ(with(2), one);
    EXPECT_EQ(with(7), one);
  }
}

TEST(Order, SerpentineOfALatticeTakesNoLongStep) {
  PointCloud cloud;
  for (int i = 0; i < 7 * 11 * 3; ++i) {
    const int x = i % 7, y = i / 7 % 11, z = i / 77;
    cloud.push_back({x * 0.1, y * 0.1, z * 0.1});
  }
  std::shuffle(cloud.begin(), cloud.end(), std::mt19937_64(18));
  const auto ordered = order::order(cloud, Ordering::serpentine, {.layer_mm = 0.1});
  EXPECT_NEAR(travel(ordered), 0.1 * (7 * 11 * 3 - 1), 1e-9);
}

TEST(Order, BestNeedsNoMoreBeatsThanTheOthersAndATenthLessThanNearestWhereBeatsAreScarce) {
  const bench::Machine machine{100, 2, 1};
  for (const bench::OrderCloud& cloud : bench::order_clouds(std::max(1500, test::scaled(3000)))) {
    const auto figures = bench::order_figures(cloud, machine);
    for (const double beats : figures.beats) {
      EXPECT_LE(figures.beats.back(), beats * 1.0005) << cloud.name;
    }
    const double nearest = figures.beats[2];
    if (nearest < 1.15) continue;  // little can be saved
    EXPECT_LT(figures.beats.back(), 0.9 * nearest) << cloud.name;
  }
}

TEST(Order, BestCompletesOneColumnAfterTheOther) {
  // Two columns 40 mm apart: their cones do not overlap, so one jump is enough.
  PointCloud legs;
  for (int i = 0; i < 200; ++i) {
    for (const double x : {0.0, 40.0}) {
      for (int k = 0; k < 6; ++k) {
        const double a = k * std::numbers::pi / 3;
        legs.push_back({x + 0.2 * std::cos(a), 0.2 * std::sin(a), i * 0.1});
      }
    }
  }
  const auto ordered = order::order(legs, Ordering::best);
  std::size_t jumps = 0;
  for (std::size_t i = 1; i < ordered.size(); ++i) {
    jumps += test::distance(ordered[i - 1], ordered[i]) > 30 ? 1u : 0u;
  }
  EXPECT_EQ(jumps, 1u);
}

TEST(Order, NamesEqualThoseOfTheOrderings) {
  for (const Ordering ordering : all_orderings) {
    EXPECT_EQ(order::ordering_named(order::ordering_names[static_cast<std::size_t>(ordering)]),
              ordering);
  }
  EXPECT_FALSE(order::ordering_named("random"));
  EXPECT_FALSE(order::ordering_named(""));
}

TEST(Order, BeginsNearTheStart) {
  PointCloud ring;
  for (int i = 0; i < 360; ++i) {
    const double a = i * std::numbers::pi / 180;
    ring.push_back({10 * std::cos(a), 10 * std::sin(a), 0});
  }
  const auto ordered = order::order(ring, Ordering::layers, {.start = {0, -12, 0}});
  EXPECT_LT(test::distance(ordered.front(), {0, -10, 0}), 0.01);
}

TEST(Order, ReportsProgressAndCanBeCancelled) {
  std::mt19937_64 random(17);
  const PointCloud cloud = test::random_cloud(random, 5000, 5);
  struct GivenUp {};
  for (const Ordering ordering : all_orderings) {
    if (ordering == Ordering::given) continue;
    OrderOptions options;
    options.layer_mm = 0.5;
    double last = 0;
    options.progress = [&](double part) {
      EXPECT_GE(part, last);
      last = part;
    };
    order::order(cloud, ordering, options);
    EXPECT_EQ(last, 1);
    options.progress = [](double) { throw GivenUp(); };
    EXPECT_THROW(order::order(cloud, ordering, options), GivenUp);
  }
}

TEST(Order, ManyEqualPointsTakeNoLonger) {
  PointCloud cloud(static_cast<std::size_t>(test::scaled(100'000)), Point{1, 2, 3});
  cloud.push_back({4, 5, 3});
  for (const Ordering ordering : all_orderings) {
    EXPECT_TRUE(is_permutation_of(order::order(cloud, ordering), cloud));
  }
}

TEST(Order, WrongOptionsAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](const OrderOptions& options, Ordering ordering = Ordering::best) {
    return !error_of([&] { order::order({{0, 0, 0}, {1, 0, 0}}, ordering, options); }).empty();
  };
  EXPECT_TRUE(refused({.layer_mm = 0}, Ordering::layers));
  EXPECT_TRUE(refused({.layer_mm = nan}, Ordering::nearest));
  EXPECT_TRUE(refused({.half_angle_deg = 90}, Ordering::layers));
  EXPECT_TRUE(refused({.half_angle_deg = nan}));
  EXPECT_TRUE(refused({.cone = {nan, 1}}, Ordering::cone));
  EXPECT_TRUE(refused({.motion = {.beat_s = 0}}));
  EXPECT_TRUE(refused({.motion = {.accel_mm_s2 = {1, 0, 1}}}));
  EXPECT_TRUE(refused({.motion = {.speed_mm_s = {1, 1, nan}}}));
  EXPECT_TRUE(refused({.motion = {.accel_mm_s2 = {1e-200, 1, 1}, .beat_s = 1e-100}}));
  for (const Ordering ordering : all_orderings) {
    EXPECT_TRUE(order::order({}, ordering, {}).empty());
  }
  EXPECT_NE(error_of([&] {
              order::order({{0, 0, 0}, {0, 0, nan}}, Ordering::best);
            }).find("point 1"),
            std::string::npos);
}

TEST(Order, MachinesOfAnySizeAreAccepted) {
  std::mt19937_64 random(20);
  const PointCloud cloud = test::random_cloud(random, 300, 50);
  for (const double size : {1e-6, 1e-2, 1e3, 1e9}) {
    OrderOptions options;
    options.motion.accel_mm_s2 = {size, size, size};
    options.motion.speed_mm_s = {1, size, 1000};
    EXPECT_TRUE(is_permutation_of(order::order(cloud, Ordering::best, options), cloud));
  }
}

}  // namespace
}  // namespace lamplock
