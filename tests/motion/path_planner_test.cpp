// The path planner on random paths: properties of every plan, and its distance from the optimum.
#include "firmware/motion/path/planner.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>

#include "firmware/motion/profile/profile.hpp"
#include "tests/motion/path_checks.hpp"
#include "tests/motion/same_plan.hpp"
#include "tests/scale.hpp"

namespace lamplock::motion {
namespace {

using test::Chain;
using test::ChainPlan;
using test::expect_valid;
using test::has_endless_line;
using test::open_work_space;
using test::PathReference;
using test::random_path;

TEST(PathPlanner, EveryPlanIsExactAndKeepsEveryLimit) {
  PathPlanner planner;
  double farthest = 0;
  int given_up = 0;
  for (int i = 0; i < test::scaled(200); ++i) {
    SCOPED_TRACE(testing::Message() << "chain " << i);
    std::mt19937_64 random(static_cast<std::uint64_t>(i) + 6100);
    const Chain chain = random_path(random, 100);
    if (has_endless_line(chain)) continue;
    const ChainPlan plan =
        test::plan_path(chain, planner, [](const PathPlanner& p, const PlanRequest& request) {
          ASSERT_TRUE(p.segment(request.count - 1).end.at_rest());
        });
    if (plan.result != Result::ok) {
      // At a speed, a full stop for a soft limit can come too soon; then the machine brakes and
      // continues from rest. This is rare.
      ASSERT_FALSE(plan.segments.back().end.at_rest());
      ++given_up;
      continue;
    }
    long ticks_to_sum = 60'000;
    ASSERT_NO_FATAL_FAILURE(expect_valid(chain, plan, ticks_to_sum, farthest));
  }
  EXPECT_LE(given_up, 1 + test::scaled(200) / 250);
  RecordProperty("farthest_from_line_steps", std::to_string(farthest));
}

TEST(PathPlanner, IsCloseToTheExactOptimum) {
  // Whole sequences without soft limits. At kilohertz whole ticks take more than 1 % of a plan.
  PathPlanner planner;
  for (const auto& [low_hz, high_hz, gap] :
       {std::array{20.0, 200.0, 0.0005}, {500.0, 5000.0, 0.003}}) {
    long planned = 0, best = 0;
    for (int i = 0; i < test::scaled(6000); ++i) {
      std::mt19937_64 random(static_cast<std::uint64_t>(i) + 6200);
      Chain chain = random_path(random, 10);
      const double hz = 1e6 / chain.limits.beat_ticks;
      if (hz < low_hz || hz > high_hz) continue;
      open_work_space(chain);
      const ChainPlan plan = test::plan_path(chain, planner);
      ASSERT_EQ(plan.result, Result::ok) << "chain " << i;
      const long fewest = PathReference::fewest_beats(chain);
      // The reference is the optimum; only a tie decided by rounding may be better.
      ASSERT_GE(plan.total_beats(), fewest - 1) << "chain " << i;
      // Where moves are whole beats, the margin for rounding to ticks costs one beat for each: a
      // single path is compared with the optimum for the planner's own limits.
      const long possible = PathReference::fewest_beats(chain, true);
      ASSERT_LE(plan.total_beats(), possible + 2 + possible / 10) << "chain " << i;
      planned += plan.total_beats();
      best += fewest;
    }
    EXPECT_GT(best, 0);
    EXPECT_LE(static_cast<double>(planned - best), gap * static_cast<double>(best) + 3);
    std::cout << low_hz << " to " << high_hz << " Hz: " << planned << " beats, fewest " << best
              << '\n';
  }
}

TEST(PathPlanner, DependsOnlyOnThePoints) {
  for (int i = 0; i < test::scaled(20); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i) + 6400);
    const Chain chain = random_path(random, 120);
    PathPlanner fresh, used;
    test::plan_path(random_path(random, 50), used);
    const ChainPlan all_at_once = test::plan_path(chain, fresh);
    const ChainPlan little_by_little =
        test::plan_path(chain, used, {}, static_cast<std::uint32_t>(1 + random() % 40));
    ASSERT_NO_FATAL_FAILURE(test::expect_same_plan(all_at_once, little_by_little));
  }
}

/// Brakes every axis at several ticks of a segment, including its first and its last.
void expect_brakes_inside(const Chain& chain, const MotionState& from, const Segment& s) {
  for (int a = 0; a < chain.limits.axes; ++a) {
    const AxisLimits& axis = chain.limits.axis[index(a)];
    const AxisProfile& p = s.axis[index(a)];
    const std::uint32_t every = 1 + s.ticks / 50;
    std::uint32_t tick = 0;
    const auto expect_inside = [&](Int128 way_q62, std::int64_t speed_q62) {
      const AxisProfile brake = make_brake(speed_q62, axis.brake_accel_q62,
                                           braking_ticks(speed_q62, axis.brake_accel_q62));
      const Int128 stop =
          from.axis[index(a)].position_q64 + ((way_q62 + stepper::displacement_q62(brake)) << 2);
      ASSERT_GE(stop.hi(), axis.min_steps) << "axis " << a << " after " << tick << " ticks";
      ASSERT_LE(stop.hi(), axis.max_steps) << "axis " << a << " after " << tick << " ticks";
    };
    ASSERT_NO_FATAL_FAILURE(expect_inside(0, p.speed_q62));
    test::for_each_tick(p, [&](test::Native way, std::int64_t speed, std::int64_t) {
      ++tick;
      if (tick % every == 0 || tick == s.ticks) expect_inside(test::to_int128(way), speed);
    });
  }
}

TEST(PathPlanner, BrakingFromAnyTickStaysInsideTheWorkSpace) {
  PathPlanner planner;
  for (int i = 0; i < test::scaled(200); ++i) {
    SCOPED_TRACE(testing::Message() << "chain " << i);
    std::mt19937_64 random(static_cast<std::uint64_t>(i) + 6500);
    const Chain chain = random_path(random, 40);
    if (chain.limits.beat_ticks > 50'000) continue;
    long ticks = 300'000;
    test::plan_path(chain, planner, [&](const PathPlanner& p, const PlanRequest& request) {
      MotionState from = request.start;
      for (std::uint32_t k = 0; k < request.commits(); ++k) {
        const Segment s = p.segment(k);
        if (ticks > 0) {
          ASSERT_NO_FATAL_FAILURE(expect_brakes_inside(chain, from, s));
        }
        ticks -= s.ticks;
        from = s.end;
      }
    });
    if (testing::Test::HasFailure()) return;
  }
}

/// A row of points, `way` steps apart.
Chain row_of(std::size_t points, std::int32_t way) {
  Chain chain;
  chain.limits = test::limits_of(test::machine_settings(100, 4, 0.1, 2, 200));
  for (std::size_t i = 0; i < points; ++i) {
    wire::Target t;
    t.steps[0] = way * static_cast<std::int32_t>(i + 1);
    chain.targets.push_back(t);
  }
  return chain;
}

TEST(PathPlanner, StopsAtReversalsAndRestsAtRepeatedPoints) {
  Chain chain = row_of(9, 50);
  for (AxisLimits& axis : chain.limits.axis)
    axis.jump_q62 = axis.speed_q62;  // practically no limit
  for (std::size_t i = 4; i < 9; ++i)
    chain.targets[i].steps[0] = 200 - 50 * static_cast<std::int32_t>(i - 4);
  chain.targets[4] = chain.targets[3];  // the same point twice, then a reversal
  PathPlanner planner;
  const ChainPlan plan = test::plan_path(chain, planner);
  ASSERT_EQ(plan.result, Result::ok);
  for (std::size_t i = 0; i < 8; ++i)
    EXPECT_EQ(plan.segments[i].end.at_rest(), i == 3 || i == 4) << i;
  EXPECT_EQ(plan.beats[4], 1);
  chain.targets.erase(chain.targets.begin() + 4);  // an immediate reversal
  const ChainPlan back = test::plan_path(chain, planner);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(back.segments[i].end.at_rest(), i == 3) << i;
}

TEST(PathPlanner, LeastBeatsAndFixedBeatsAreKept) {
  Chain chain = row_of(10, 2);
  chain.targets[6].shots = 0;
  test::WholeRequest whole(chain);
  whole.request.min_beats = 3;
  PathPlanner planner;
  std::uint32_t failed = 0;
  ASSERT_EQ(planner.plan(whole.request, failed), Result::ok);
  for (std::uint32_t i = 0; i < 10; ++i) EXPECT_EQ(planner.beats(i), i == 6 ? 1 : 3);
  // Shots must not exceed the rate either if the host fixes beats; a move without a shot may.
  chain.targets[4].beats = 2;
  for (const std::uint8_t shots : std::array<std::uint8_t, 2>{1, 0}) {
    chain.targets[4].shots = shots;
    whole.fill(chain);
    EXPECT_EQ(planner.plan(whole.request, failed), shots == 1 ? Result::unreachable : Result::ok);
    EXPECT_TRUE(shots == 0 ? planner.beats(4) == 2 : failed == 4);
  }
}

TEST(PathPlanner, ATargetOutsideTheWorkSpaceIsNamed) {
  for (const std::uint32_t bad : {0u, 4u, 9u}) {
    Chain chain = row_of(10, 2);
    for (std::uint32_t i = bad; i < 10; ++i) chain.targets[i].steps[1] = 1'000'000;
    chain.limits.axis[1].max_steps = 500'000;
    const test::WholeRequest whole(chain);
    PathPlanner planner;
    std::uint32_t failed = 99;
    EXPECT_EQ(planner.plan(whole.request, failed), Result::unreachable);
    EXPECT_EQ(failed, bad);
  }
}

TEST(PathPlanner, FixedBeatsOfAPlanArePossible) {
  PathPlanner planner;
  for (int i = 0; i < test::scaled(40); ++i) {
    SCOPED_TRACE(testing::Message() << "chain " << i);
    std::mt19937_64 random(static_cast<std::uint64_t>(i) + 6300);
    Chain chain = random_path(random, 14);
    if (has_endless_line(chain)) continue;
    open_work_space(chain);
    const ChainPlan plan = test::plan_path(chain, planner);
    ASSERT_EQ(plan.result, Result::ok);
    for (std::size_t k = 0; k < chain.targets.size(); ++k)
      chain.targets[k].beats = static_cast<std::uint16_t>(plan.beats[k]);
    const ChainPlan ordered = test::plan_path(chain, planner);
    long ticks_to_sum = 0;
    double farthest = 0;
    ASSERT_NO_FATAL_FAILURE(expect_valid(chain, ordered, ticks_to_sum, farthest));
  }
}

}  // namespace
}  // namespace lamplock::motion
