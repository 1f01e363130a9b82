// Speeds along a line with limited jerk, compared with pairs of speeds tried one by one and with
// the seven phases of the textbooks, and on dense rows.
#include "firmware/motion/path/pulse_line.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "firmware/motion/path/planner.hpp"
#include "host/bench/walks.hpp"
#include "tests/motion/path_chain.hpp"
#include "tests/scale.hpp"

namespace lamplock::motion {
namespace {

using test::Chain;
using test::ChainPlan;

constexpr double one = 4294967296.0;

double real(std::int64_t v_q32) { return static_cast<double>(v_q32) / one; }
std::int64_t q32(double v) { return static_cast<std::int64_t>(std::lround(v * one)); }

/// Change of speed of a pulse by its definition: the acceleration rises in `rise` to 1, or as far
/// as half the length allows, and falls again. Ramps are slightly longer than necessary.
double change_of_pulse(const PulseLine& line, double length) {
  const double rise = real(line.rise_q32);
  if (length > 2 * (rise + length / 128)) return length - rise - length / 128;
  return length * length / (4 * rise) * 63 / 64;
}

/// Excess of a pair of speeds over what one division of the time can reach; <= 0 if reachable.
double excess(const PulseLine& line, double v0, double v1, std::int32_t beats, int split) {
  const PulseLengths pulses = pulse_lengths(line, beats, split);
  const double lead = real(pulses.lead_q32), tail = real(pulses.tail_q32);
  const double vc =
      (real(line.displacement_q32) - v0 * lead / 2 - v1 * tail / 2) / (beats - lead / 2 - tail / 2);
  return std::max({-vc, vc - real(line.speed_q32), std::fabs(vc - v0) - change_of_pulse(line, lead),
                   std::fabs(v1 - vc) - change_of_pulse(line, tail)});
}

struct Question {
  PulseLine line;
  SpeedInterval from;
  std::int32_t beats = 1;
  int split = 0;
};

Question random_question(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  Question q;
  const double limit = std::pow(10, 3 * unit(random) - 1);
  q.beats = 1 + static_cast<std::int32_t>(random() % 20);
  q.split = static_cast<int>(random() % pulse_splits);
  const double way = std::min(limit, q.beats / 4.0) * q.beats * unit(random);
  q.line = make_pulse_line(1 + q32(way), q32(limit), q32(std::pow(10, 3 * unit(random) - 2)), 0);
  const double a = std::min(limit, 1.0 * q.beats) * unit(random), b = a * unit(random);
  q.from = {random() % 3 == 0 ? 0 : q32(b), q32(a)};
  return q;
}

TEST(PulseLine, ReachesAllPairsFoundOneByOne) {
  std::mt19937_64 random(7800);
  int some = 0;
  for (int i = 0; i < test::scaled(3'000); ++i) {
    SCOPED_TRACE(i);
    const Question q = random_question(random);
    SpeedInterval to;
    const std::int64_t end = q.line.speed_q32;
    const bool found = pulse_reach(q.line, q.from, q.beats, q.split, end, to);
    // A grid finds at most the true interval, and misses only what lies between its points.
    constexpr int points = 60;
    double low = 1e9, high = -1e9;
    for (int m = 0; m <= points; ++m)
      for (int n = 0; n <= points; ++n) {
        const double v0 =
            real(q.from.lo_q32) + (real(q.from.hi_q32) - real(q.from.lo_q32)) * m / points;
        const double v1 = real(end) * n / points;
        if (excess(q.line, v0, v1, q.beats, q.split) > 0) continue;
        low = std::min(low, v1);
        high = std::max(high, v1);
      }
    if (high < low && !found) continue;
    ASSERT_TRUE(found || high < low);
    if (!found) continue;
    ++some;
    ASSERT_LE(real(to.lo_q32), low + 1e-6);
    ASSERT_GE(real(to.hi_q32), high - 1e-6);
    // Both ends can be reached from some speed.
    for (const std::int64_t v1 : {to.lo_q32, to.hi_q32}) {
      // The excess is convex in v0.
      double a = real(q.from.lo_q32), b = real(q.from.hi_q32);
      for (int m = 0; m < 100; ++m) {
        const double left = a + (b - a) / 3, right = b - (b - a) / 3;
        if (excess(q.line, left, real(v1), q.beats, q.split) <
            excess(q.line, right, real(v1), q.beats, q.split))
          b = right;
        else
          a = left;
      }
      ASSERT_LE(excess(q.line, a, real(v1), q.beats, q.split), 1e-6);
    }
  }
  EXPECT_GT(some, test::scaled(3'000) / 8);
}

TEST(PulseLine, FewestBeatsAreTheFirstThatReachAnySpeed) {
  std::mt19937_64 random(7801);
  int some = 0;
  for (int i = 0; i < test::scaled(3'000); ++i) {
    SCOPED_TRACE(i);
    const Question q = random_question(random);
    const std::int64_t end = q32(real(q.line.speed_q32) * 0.5);
    std::int32_t first = 0;
    for (std::int32_t k = 1; k <= 60 && first == 0; ++k)
      for (int split = 0; split < pulse_splits; ++split) {
        SpeedInterval to;
        if (first == 0 && pulse_reach(q.line, q.from, k, split, end, to)) first = k;
      }
    const std::int32_t fewest = fewest_pulse_beats(q.line, q.from, end, 1, 60, 1 + i % 70);
    some += fewest != 0;
    if (first == fewest) continue;
    // Answers that are possible only by the last bits may be missed; answers slower than from rest
    // to rest are not searched.
    ASSERT_TRUE(fewest == 0 || fewest > first) << first << " " << fewest;
    const std::int32_t rest = fewest_pulse_beats(q.line, {0, 0}, 0, 1, 8192, 1);
    ASSERT_TRUE(fewest != 0 || first > rest) << first << " of " << rest;
  }
  EXPECT_GT(some, test::scaled(3'000) / 2);
}

settings::Values machine(double hz, double accel, double speed, double jerk, int axes) {
  settings::Values values = test::machine_settings(hz, accel, speed, axes, 500);
  for (int a = 0; a < axes; ++a)
    values.set_milli(settings::for_axis(settings::Id::jerk_x, a),
                     static_cast<std::int32_t>(std::lround(jerk * 1000)));
  return values;
}

/// Seconds from rest to rest: up to seven phases, in closed form except for the highest speed.
double textbook_time(double way, double speed, double accel, double jerk) {
  const auto ramp = [&](double v) {
    return v * jerk > accel * accel ? v / accel + accel / jerk : 2 * std::sqrt(v / jerk);
  };
  if (speed * ramp(speed) <= way) return 2 * ramp(speed) + (way - speed * ramp(speed)) / speed;
  double low = 0, high = speed;
  for (int i = 0; i < 100; ++i) {
    const double middle = (low + high) / 2;
    (middle * ramp(middle) < way ? low : high) = middle;
  }
  return 2 * ramp(low);
}

TEST(PulseLine, OneLineTakesLittleMoreThanTheSevenPhasesOfTheTextbooks) {
  std::mt19937_64 random(7802);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto planner = std::make_unique<PathPlanner>();
  for (int i = 0; i < test::scaled(2'000); ++i) {
    const double hz = std::pow(10, 1 + 2.69 * unit(random)),
                 speed = std::pow(10, 2 * unit(random) - 2),
                 accel = std::pow(10, 2 * unit(random) - 0.5),
                 jerk = std::max(1.0, accel * hz * 0.05 * std::pow(400, unit(random)));
    const double steps = speed * speed / accel * std::pow(10, 4 * unit(random) - 2) * 500'000;
    // Lines and ramps of thousands of beats exceed the resolution of the search.
    if (speed / accel * hz > 2000 || steps / 500'000 / speed * hz > 4000) continue;
    if (steps < 20 || steps > 1e8) continue;
    Chain chain;
    chain.limits = test::limits_of(machine(hz, accel, speed, jerk, 1));
    chain.limits.axis[0].max_steps = 200'000'000;
    wire::Target t;
    t.steps[0] = static_cast<std::int32_t>(steps);
    chain.targets = {t};
    const ChainPlan plan = test::plan_path(chain, *planner);
    ASSERT_EQ(plan.result, Result::ok);
    const double beats = hz * textbook_time(t.steps[0] / 500e3, speed, accel, jerk);
    ASSERT_GE(plan.total_beats(), std::ceil(beats * 0.9999 - 2 * flat_rise_ticks * 1e-6 * hz))
        << hz << " Hz, " << accel << " m/s2, " << jerk << " m/s3, " << t.steps[0] << " steps";
    // Allows for the rounding of ramps to stairs, and for the reserve of acceleration.
    ASSERT_LE(plan.total_beats(), std::ceil(beats * 1.03 + 10e-6 * 64 * hz))
        << hz << " Hz, " << accel << " m/s2, " << jerk << " m/s3, " << t.steps[0] << " steps";
  }
}

TEST(PulseLine, HighJerkCostsDenseRowsNothing) {
  // The example of the thesis (pulse_path_test.cpp), and a faster machine: at constant speed little
  // acceleration is used.
  struct Row {
    double hz, speed, accel, jerk, most;
  };
  const auto planner = std::make_unique<PathPlanner>();
  for (const Row& row : {Row{40, 0.03, 0.3, 100, 1.01}, Row{100, 0.1, 2, 500, 1.01},
                         Row{100, 0.1, 4, 1000, 1.01}, Row{200, 1, 10, 5000, 1.01}}) {
    Chain chain;
    chain.limits = test::limits_of(machine(row.hz, row.accel, row.speed, row.jerk, 2));
    chain.targets = bench::course(bench::Course::straight, 1200, 500, 3);
    const ChainPlan plan = test::plan_path(chain, *planner);
    ASSERT_EQ(plan.result, Result::ok);
    EXPECT_LE(static_cast<double>(plan.total_beats()), row.most * 1200) << row.hz << " Hz";
  }
}

TEST(PulseLine, AnyJerkAllowsAContinuationFromSpeed) {
  // A window begins at the final speed of the preceding one; a continuation always exists.
  const auto planner = std::make_unique<PathPlanner>();
  for (int seed = 1; seed <= test::scaled(3); ++seed)
    for (const auto& [hz, speed, accel] :
         {std::array{40.0, 0.03, 0.3}, {100.0, 0.1, 2.0}, {1000.0, 1.0, 10.0}, {4000.0, 1.0, 10.0}})
      for (const double jerk : {5000.0, 1000.0, 200.0, 20.0})
        for (const bench::Course course : {bench::Course::straight, bench::Course::stairs}) {
          settings::Values values = machine(hz, accel, speed, jerk, 2);
          for (int a = 0; a < 2; ++a)
            values.set_milli(settings::for_axis(settings::Id::speed_jump_x, a), 750);
          Chain chain;
          chain.limits = test::limits_of(values);
          chain.targets = bench::course(course, 500, 500, static_cast<std::uint64_t>(seed));
          EXPECT_EQ(test::plan_path(chain, *planner).result, Result::ok)
              << hz << " Hz, " << jerk << " m/s3, seed " << seed;
        }
}

}  // namespace
}  // namespace lamplock::motion
