// The path planner on random paths: what holds for every plan, and how near the optimum it comes.
#include "firmware/motion/path_planner.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>

#include "firmware/motion/profile.hpp"
#include "tests/motion/path_chain.hpp"
#include "tests/motion/same_plan.hpp"
#include "tests/motion/tick_sum.hpp"
#include "tests/native_int128.hpp"
#include "tests/scale.hpp"

namespace lamplock::motion {
namespace {

using test::Chain;
using test::ChainPlan;
using test::native;
using test::PathReference;
using test::Vector;

constexpr double unit_q64 = 18446744073709551616.0;  // 2^64

double steps_of(Int128 position_q64) {
  return static_cast<double>(native(position_q64)) / unit_q64 - 0.5;
}

/// Random machine and path: what random_chain() gives, bent less, with points again and again, ways
/// back, rows, moves without a shot, and axes of different steps/mm.
Chain random_path(std::mt19937_64& random, std::size_t points) {
  Chain chain = test::random_chain(random, points);
  std::uniform_real_distribution<double> unit(0, 1);
  const double beat = chain.limits.beat_ticks;
  const bool stop_at_corners = random() % 3 == 0;
  const double jump_steps = std::pow(10, 3 * unit(random) - 1);
  for (AxisLimits& axis : chain.limits.axis)
    axis.jump_q62 =
        stop_at_corners
            ? 0
            : static_cast<std::int64_t>(std::ldexp(std::min(0.9 * beat, jump_steps) / beat, 62));
  if (random() % 2 == 0)
    for (int a = 1; a < chain.limits.axes; ++a)
      chain.limits.axis[index(a)].weight_q31 =
          static_cast<std::uint32_t>(2147483648.0 * std::pow(0.05, unit(random)));
  for (std::size_t i = 2; i < points; ++i) {
    Target& t = chain.targets[i];
    const StepPosition &before = chain.targets[i - 1].steps, &first = chain.targets[i - 2].steps;
    const auto kind = random() % 8;
    for (int a = 0; a < chain.limits.axes; ++a) {
      const std::size_t k = index(a);
      if (kind == 0) t.steps[k] = before[k];
      if (kind == 1) t.steps[k] = first[k];
      const std::int64_t on = 2 * std::int64_t{before[k]} - first[k];
      if (kind >= 4 && std::abs(on) < 100'000'000) {
        t.steps[k] = static_cast<std::int32_t>(on);
        if (kind == 7) t.steps[k] += static_cast<std::int32_t>(random() % 3) - 1;
      }
    }
  }
  test::tighten_work_space(chain);
  return chain;
}

/// Without soft limits, which the reference does not know.
void open_work_space(Chain& chain) {
  for (AxisLimits& axis : chain.limits.axis) {
    axis.min_steps = -2'000'000'000;
    axis.max_steps = 2'000'000'000;
  }
}

/// True if a line takes longer than a segment may.
bool has_endless_line(const Chain& chain) {
  for (std::size_t i = 0; i < chain.targets.size(); ++i)
    for (std::size_t a = 0; a < static_cast<std::size_t>(chain.limits.axes); ++a)
      if (std::fabs(test::way_to(chain, i)[a]) / test::from_q62(chain.limits.axis[a].speed_q62) >
          0.9 * (1 << 30))
        return true;
  return false;
}

/// A segment starts where and when the one before it ended.
void expect_joined(const Chain& chain, const MotionState& from, const Segment& s,
                   std::int32_t beats) {
  ASSERT_EQ(s.start_tick, from.tick);
  ASSERT_GE(beats, 1);
  ASSERT_EQ(s.ticks, static_cast<std::uint32_t>(beats) * chain.limits.beat_ticks);
  ASSERT_EQ(s.end.tick, s.start_tick + s.ticks);
  for (int a = 0; a < chain.limits.axes; ++a) {
    const AxisProfile& p = s.axis[index(a)];
    ASSERT_EQ(p.ticks(), s.ticks);
    ASSERT_EQ(p.lead_ticks, s.axis[0].lead_ticks);
    ASSERT_EQ(p.cruise_ticks, s.axis[0].cruise_ticks);
    ASSERT_EQ(native(s.end.axis[index(a)].position_q64),
              native(from.axis[index(a)].position_q64 + (stepper::displacement_q62(p) << 2)));
    ASSERT_LE(abs64(p.end_speed_q62() - s.end.axis[index(a)].speed_q62),
              2 * static_cast<std::int64_t>(p.tail_ticks));
  }
}

/// The point: in the middle of its step on every axis, the shot as ordered.
void expect_at_point(const Chain& chain, const Segment& s, std::uint32_t point) {
  const Target& target = chain.targets[point];
  ASSERT_TRUE(s.ends_point);
  ASSERT_EQ(s.point, point);
  ASSERT_EQ(s.shot.present, target.shots != 0);
  if (s.shot.present) {
    ASSERT_GE(s.shot.half_window_ticks, 1u);
    ASSERT_LE(s.shot.half_window_ticks, chain.limits.beat_ticks / 4);
  }
  for (int a = 0; a < chain.limits.axes; ++a) {
    const Int128 at = s.end.axis[index(a)].position_q64;
    ASSERT_EQ(at.hi(), target.steps[index(a)]);
    const double n = s.ticks;
    ASSERT_LT(std::fabs(steps_of(at) - target.steps[index(a)]), 1e-6 + 2 * n * n / 4.6e18);
  }
}

/// Speed and acceleration by the ends of the phases, the work space by excursions.
void expect_limits(const Chain& chain, const MotionState& from, const Segment& s) {
  for (int a = 0; a < chain.limits.axes; ++a) {
    const AxisLimits& axis = chain.limits.axis[index(a)];
    const AxisProfile& p = s.axis[index(a)];
    for (const std::int64_t speed : {p.speed_q62, p.cruise_speed_q62(), p.end_speed_q62()})
      ASSERT_LE(abs64(speed), axis.speed_q62);
    ASSERT_LE(abs64(p.lead_accel_q62), axis.accel_q62);
    ASSERT_LE(abs64(p.tail_accel_q62), axis.accel_q62);
    const Excursion e = excursion(p);
    const Int128 start = from.axis[index(a)].position_q64;
    ASSERT_GE((start + (e.low_q62 << 2)).hi(), axis.min_steps);
    ASSERT_LE((start + (e.high_q62 << 2)).hi(), axis.max_steps);
  }
}

/// Speed jumps: what is set for the corner itself, and what rounding may add.
void expect_jumps(const Chain& chain, const MotionState& from, const Segment& s, std::size_t i) {
  const double beat = chain.limits.beat_ticks;
  for (int a = 0; a < chain.limits.axes; ++a) {
    const AxisLimits& axis = chain.limits.axis[index(a)];
    const double jump =
        test::from_q62(s.axis[index(a)].speed_q62 - from.axis[index(a)].speed_q62) * beat;
    const double set = test::from_q62(axis.jump_q62) * beat;
    // Speeds are whole multiples of 2^-32 of what the acceleration makes in a beat.
    const double unit = test::from_q62(axis.accel_q62) * beat * beat * 0x1p-32;
    ASSERT_LE(std::fabs(jump), (set + rounding_jump_steps) * (1 + 1e-6) + 4 * unit) << a;
  }
  if (i == 0) return;
  const Vector before = test::way_to(chain, i - 1), behind = test::way_to(chain, i);
  Vector speed{};
  for (std::size_t a = 0; a < speed.size(); ++a)
    speed[a] = test::from_q62(from.axis[a].speed_q62) * beat;
  if (test::length_of(chain, before) == 0 || test::length_of(chain, behind) == 0) {
    ASSERT_TRUE(from.at_rest());
    return;
  }
  ASSERT_LE(test::length_of(chain, speed),
            test::real_corner_speed(chain, before, behind, 3e-7) * (1 + 1e-5));
}

/// Every some tick: speed, acceleration, the line, and no way back.
void expect_on_line(const Chain& chain, const MotionState& from, const Segment& s, std::size_t i,
                    double& farthest) {
  const auto axes = static_cast<std::size_t>(chain.limits.axes);
  const Vector way = test::way_to(chain, i);
  double squares = 0;
  for (const double w : way) squares += w * w;
  std::vector<Vector> at((s.ticks + 96) / 97);
  for (std::size_t a = 0; a < axes; ++a) {
    const test::TickSum sum = test::sum_ticks(s.axis[a]);
    ASSERT_LE(sum.largest_speed_q62, chain.limits.axis[a].speed_q62);
    ASSERT_LE(sum.largest_accel_q62, chain.limits.axis[a].accel_q62);
    ASSERT_EQ(sum.sign_changes_outside_turns, 0);
    const double start = steps_of(from.axis[a].position_q64) -
                         (i == 0 ? 0.0 : static_cast<double>(chain.targets[i - 1].steps[a]));
    std::size_t tick = 0;
    test::for_each_tick(s.axis[a], [&](test::Native position, std::int64_t, std::int64_t) {
      if (tick % 97 == 0) at[tick / 97][a] = start + std::ldexp(static_cast<double>(position), -62);
      ++tick;
    });
  }
  double done = 0;
  for (const Vector& point : at) {
    double along = 0;
    for (std::size_t a = 0; a < axes; ++a) along += point[a] * way[a];
    const double share = squares == 0 ? 0 : along / squares;
    double off = 0;
    for (std::size_t a = 0; a < axes; ++a) off += std::pow(point[a] - share * way[a], 2);
    farthest = std::max(farthest, std::sqrt(off));
    ASSERT_LT(std::sqrt(off), 0.01);
    ASSERT_GE(share * std::sqrt(squares), done - 1);
    done = share * std::sqrt(squares);
  }
}

void expect_valid(const Chain& chain, const ChainPlan& plan, long& ticks_to_sum, double& farthest) {
  ASSERT_EQ(plan.result, Result::ok);
  ASSERT_EQ(plan.segments.size(), chain.targets.size());
  MotionState from = test::rest_at_zero();
  for (std::uint32_t i = 0; i < plan.segments.size(); ++i) {
    const Segment& s = plan.segments[i];
    SCOPED_TRACE(testing::Message() << "segment " << i);
    ASSERT_NO_FATAL_FAILURE(expect_joined(chain, from, s, plan.beats[i]));
    ASSERT_NO_FATAL_FAILURE(expect_at_point(chain, s, i));
    ASSERT_NO_FATAL_FAILURE(expect_limits(chain, from, s));
    ASSERT_NO_FATAL_FAILURE(expect_jumps(chain, from, s, i));
    if (ticks_to_sum > 0 && i % 5 == 0) {
      ticks_to_sum -= s.ticks;
      ASSERT_NO_FATAL_FAILURE(expect_on_line(chain, from, s, i, farthest));
    }
    if (chain.targets[i].beats != 0) {
      ASSERT_EQ(plan.beats[i], chain.targets[i].beats);
    }
    from = s.end;
  }
  ASSERT_TRUE(from.at_rest());
}

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
      // From speed, a full stop that a soft limit asks for can come too soon; then the machine
      // brakes and goes on from rest. Rare.
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

TEST(PathPlanner, ComesNearTheExactOptimum) {
  // Whole sequences, without soft limits. In kHz a plan has room for whole ticks of more than 1 %.
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
      // The reference is the optimum; a tie that rounding decides is all that may beat it.
      ASSERT_GE(plan.total_beats(), fewest - 1) << "chain " << i;
      ASSERT_LE(plan.total_beats(), fewest + 2 + fewest / 10) << "chain " << i;
      planned += plan.total_beats();
      best += fewest;
    }
    EXPECT_GT(best, 0);
    EXPECT_LE(static_cast<double>(planned - best), gap * static_cast<double>(best) + 3);
    std::cout << low_hz << " to " << high_hz << " Hz: " << planned << " beats, fewest " << best
              << '\n';
  }
}

TEST(PathPlanner, DependsOnThePointsAlone) {
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

/// Brakes every axis after some ticks of a segment, its first and its last among them.
void expect_brakes_inside(const Chain& chain, const MotionState& from, const Segment& s) {
  for (int a = 0; a < chain.limits.axes; ++a) {
    const AxisLimits& axis = chain.limits.axis[index(a)];
    const AxisProfile& p = s.axis[index(a)];
    const std::uint32_t every = 1 + s.ticks / 50;
    std::uint32_t tick = 0;
    const auto expect_inside = [&](Int128 way_q62, std::int64_t speed_q62) {
      const AxisProfile brake =
          make_brake(speed_q62, axis.plan_accel_q62, braking_ticks(speed_q62, axis.plan_accel_q62));
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

/// A row of points, `way` steps from each to the next.
Chain row_of(std::size_t points, std::int32_t way) {
  Chain chain;
  chain.limits = test::limits_of(test::machine_settings(100, 4, 0.1, 2, 200));
  for (std::size_t i = 0; i < points; ++i) {
    Target t;
    t.steps[0] = way * static_cast<std::int32_t>(i + 1);
    chain.targets.push_back(t);
  }
  return chain;
}

TEST(PathPlanner, StopsWhereThePathGoesBackAndStandsAtTheSamePoint) {
  Chain chain = row_of(9, 50);
  for (AxisLimits& axis : chain.limits.axis) axis.jump_q62 = axis.speed_q62;  // as good as no limit
  for (std::size_t i = 4; i < 9; ++i)
    chain.targets[i].steps[0] = 200 - 50 * static_cast<std::int32_t>(i - 4);
  chain.targets[4] = chain.targets[3];  // twice the same, then back
  PathPlanner planner;
  const ChainPlan plan = test::plan_path(chain, planner);
  ASSERT_EQ(plan.result, Result::ok);
  for (std::size_t i = 0; i < 8; ++i)
    EXPECT_EQ(plan.segments[i].end.at_rest(), i == 3 || i == 4) << i;
  EXPECT_EQ(plan.beats[4], 1);
  chain.targets.erase(chain.targets.begin() + 4);  // back at once
  const ChainPlan back = test::plan_path(chain, planner);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(back.segments[i].end.at_rest(), i == 3) << i;
}

TEST(PathPlanner, LeastBeatsAndFixedBeatsAreKept) {
  Chain chain = row_of(10, 2);
  PointQueue queue;
  PlanRequest request;
  request.queue = &queue;
  request.count = 10;
  for (std::uint32_t i = 0; i < 10; ++i) request.points[i] = i;
  request.limits = &chain.limits;
  request.start = test::rest_at_zero();
  request.least_beats = 3;
  chain.targets[6].shots = 0;
  for (const Target& t : chain.targets) queue.push(t);
  PathPlanner planner;
  std::uint32_t failed = 0;
  ASSERT_EQ(planner.plan(request, failed), Result::ok);
  for (std::uint32_t i = 0; i < 10; ++i) EXPECT_EQ(planner.beats(i), i == 6 ? 1 : 3);
  // Beats that the host fixes do not outrun it either; a move without a shot may.
  chain.targets[4].beats = 2;
  for (const std::uint8_t shots : std::array<std::uint8_t, 2>{1, 0}) {
    chain.targets[4].shots = shots;
    queue.reset(0);
    for (const Target& t : chain.targets) queue.push(t);
    EXPECT_EQ(planner.plan(request, failed), shots == 1 ? Result::unreachable : Result::ok);
    EXPECT_TRUE(shots == 0 ? planner.beats(4) == 2 : failed == 4);
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
