// The example of "Abstract of a master's thesis on the flexibility of CNC systems for laser
// processing" (BSUIR): 1200 points 100 to 150 um apart, 0.3 m/s2, 30 mm/s, lamp 40 Hz.
//
// Start-stop takes two lamp periods for every point. Along a path every lamp pulse should find a
// point, except at the start, the end and the corners.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <iostream>
#include <memory>
#include <random>

#include "host/bench/walks.hpp"
#include "tests/motion/path_chain.hpp"

namespace lamplock::motion {
namespace {

using test::Chain;

constexpr std::size_t points = 1200;

/// Position of the path at `way_mm` from its start, and of point `i`.
using Shape = std::function<std::array<double, 2>(double way_mm, std::size_t i)>;

/// Points of a shape, at random or equal distances, for a machine of the example.
Chain example(const Shape& shape, double steps_per_mm, double jump_mm_s, bool even) {
  settings::Values values = test::machine_settings(40, 0.3, 0.03, 2, steps_per_mm);
  for (int a = 0; a < 2; ++a)
    values.set_milli(settings::for_axis(settings::Id::speed_jump_x, a),
                     static_cast<std::int32_t>(std::lround(jump_mm_s * 1000)));
  Chain chain;
  chain.limits = test::limits_of(values);
  std::mt19937_64 random(71);
  std::uniform_real_distribution<double> spacing(0.1, 0.15);
  double way = 0;
  const std::array<double, 2> origin = shape(0, 0);
  for (std::size_t i = 0; i < points; ++i) {
    way += even ? 0.125 : spacing(random);
    const std::array<double, 2> at = shape(way, i + 1);
    wire::Target t;
    for (std::size_t a = 0; a < 2; ++a)
      t.steps[a] = static_cast<std::int32_t>(std::lround((at[a] - origin[a]) * steps_per_mm));
    chain.targets.push_back(t);
  }
  return chain;
}

double beats_per_point(const Chain& chain) {
  PathPlanner planner;
  const test::ChainPlan plan = test::plan_path(chain, planner);
  EXPECT_EQ(plan.result, Result::ok);
  return static_cast<double>(plan.total_beats()) / points;
}

Shape straight(double degrees) {
  const double angle = degrees * std::acos(-1.0) / 180;
  return [angle](double way, std::size_t) {
    return std::array{way * std::cos(angle), way * std::sin(angle)};
  };
}

Shape circle(double radius_mm) {
  return [radius_mm](double way, std::size_t) {
    return std::array{radius_mm * std::cos(way / radius_mm), radius_mm * std::sin(way / radius_mm)};
  };
}

/// Right angles every 15 points, alternately left and right or always left, rotated by an angle.
/// The corner is a point of the path.
Shape corners(bool zigzag, double degrees) {
  struct State {
    double way = 0;
    std::array<double, 2> at{};
  };
  const double angle = degrees * std::acos(-1.0) / 180;
  const auto state = std::make_shared<State>();
  return [=](double way, std::size_t i) {
    if (i == 0) *state = {};
    const std::size_t side = (i == 0 ? 0 : i - 1) / 15;
    const double heading =
        angle + std::acos(0.0) * static_cast<double>(zigzag ? side % 2 : side % 4);
    state->at[0] += (way - state->way) * std::cos(heading);
    state->at[1] += (way - state->way) * std::sin(heading);
    state->way = way;
    return state->at;
  };
}

const std::vector<double> resolutions{200, 400, 1000};

TEST(PulseExample, StartStopTakesTwoPeriodsPerPoint) {
  for (const double per_mm : resolutions) {
    Chain chain = example(straight(0), per_mm, 0, false);
    chain.mode = wire::JoinMode::start_stop;
    Planner planner;
    const test::ChainPlan plan = test::plan_chain(chain, planner);
    ASSERT_EQ(plan.result, Result::ok);
    EXPECT_EQ(plan.total_beats(), 2 * static_cast<long>(points)) << per_mm;
  }
}

TEST(PulseExample, StraightRowsTakeOneWithoutASpeedJump) {
  for (const double per_mm : resolutions)
    for (const double degrees : {0.0, 1.0, 17.3, 45.0, 63.4, 90.0})
      for (const bool even : {true, false}) {
        const double per_point = beats_per_point(example(straight(degrees), per_mm, 0, even));
        EXPECT_LE(per_point, 1.01) << per_mm << " steps/mm, " << degrees << " degrees";
      }
}

TEST(PulseExample, CirclesTakeOneWithASmallSpeedJump) {
  // At 6 mm/s each point changes the velocity by 6 mm/s x 0.15 mm / radius: 0.18 mm/s at 5 mm.
  for (const double per_mm : resolutions)
    for (const double radius_mm : {5.0, 10.0, 30.0})
      for (const bool even : {true, false}) {
        const double per_point = beats_per_point(example(circle(radius_mm), per_mm, 0.2, even));
        EXPECT_LE(per_point, 1.01) << per_mm << " steps/mm, radius " << radius_mm << " mm";
      }
}

TEST(PulseExample, SharpCornersEveryFifteenPoints) {
  for (const double per_mm : resolutions)
    for (const bool zigzag : {false, true})
      for (const double degrees : {0.0, 17.3, 45.0}) {
        const Shape shape = corners(zigzag, degrees);
        SCOPED_TRACE(testing::Message() << per_mm << " steps/mm, " << degrees << " degrees");
        const double stops = beats_per_point(example(shape, per_mm, 0, false));
        const double jumps = beats_per_point(example(shape, per_mm, 0.75, false));
        EXPECT_GE(stops, 1.04);  // they are stops
        EXPECT_LE(stops, 1.25);
        EXPECT_LE(jumps, 1.10 + 1e-9);
        // From 0.75 mm/s one beat covers 0.1125 mm at most: points 0.125 mm apart are too far.
        EXPECT_LE(beats_per_point(example(shape, per_mm, 0, true)), 1.14);
        EXPECT_LE(beats_per_point(example(shape, per_mm, 0.75, true)), 1.14);
      }
}

TEST(PulseExample, CornersWithAJumpEqualTheExactSearch) {
  // From 0.75 mm/s one beat covers 0.75 mm/s x 25 ms + 0.3 m/s2 x (25 ms)^2 / 2 = 0.1125 mm. The
  // lines before and after a corner need a second beat if they are longer: three in four of random
  // lengths from 0.1 to 0.15 mm. So 15 lines take 15 + 2 x 3/4 beats, 1.100 a point, within 0.005
  // in 1200 points, and no plan can be better.
  const auto resolution = 500.0;
  long planned = 0, optimum = 0;
  constexpr std::size_t seeds = 40;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    Chain chain = example(straight(0), resolution, 0.75, true);
    chain.targets = bench::course(bench::Course::stairs, points, resolution, seed);
    PathPlanner planner;
    const test::ChainPlan plan = test::plan_path(chain, planner);
    ASSERT_EQ(plan.result, Result::ok);
    const long best = test::PathReference::fewest_beats(chain);
    EXPECT_LE(plan.total_beats(), best + 3) << "seed " << seed;
    planned += plan.total_beats();
    optimum += best;
  }
  std::cout << "corners with a jump of 0.75 mm/s: "
            << static_cast<double>(planned) / (seeds * points) << " beats a point, optimum "
            << static_cast<double>(optimum) / (seeds * points) << "\n";
  EXPECT_EQ(planned, optimum);
  EXPECT_LE(static_cast<double>(planned), 1.10 * seeds * points);
}

}  // namespace
}  // namespace lamplock::motion
