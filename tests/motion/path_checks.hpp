// Random paths, and checks that hold for every plan of a path.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "firmware/motion/profile/profile.hpp"
#include "tests/motion/path_chain.hpp"
#include "tests/motion/plan_checks.hpp"
#include "tests/native_int128.hpp"

namespace lamplock::test {

inline double steps_of(Int128 position_q64) {
  return std::ldexp(static_cast<double>(native(position_q64)), -64) - 0.5;
}

/// Random machine and path: random_chain() with gentler bends, repeated points, reversals, rows,
/// moves without a shot, and axes of different steps/mm; with or without limits of jerk.
inline Chain random_path(std::mt19937_64& random, std::size_t points, bool jerk = false) {
  Chain chain = random_chain(random, points);
  if (jerk) limit_jerk(chain, random);
  std::uniform_real_distribution<double> unit(0, 1);
  const double beat = chain.limits.beat_ticks;
  const bool stop_at_corners = random() % 3 == 0;
  const double jump_steps = std::pow(10, 3 * unit(random) - 1);
  for (motion::AxisLimits& axis : chain.limits.axis)
    axis.jump_q62 =
        stop_at_corners
            ? 0
            : static_cast<std::int64_t>(std::ldexp(std::min(0.9 * beat, jump_steps) / beat, 62));
  if (random() % 2 == 0)
    for (int a = 1; a < chain.limits.axes; ++a)
      chain.limits.axis[index(a)].weight_q31 =
          static_cast<std::uint32_t>(2147483648.0 * std::pow(0.05, unit(random)));
  for (std::size_t i = 2; i < points; ++i) {
    wire::Target& t = chain.targets[i];
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
  tighten_work_space(chain);
  return chain;
}

/// True if a line takes more ticks than a segment or a point may have.
inline bool has_endless_line(const Chain& chain, double max_ticks = 1 << 30) {
  max_ticks = std::min(max_ticks, 1.0 * motion::max_beats_per_point * chain.limits.beat_ticks);
  for (std::size_t i = 0; i < chain.targets.size(); ++i)
    for (std::size_t a = 0; a < static_cast<std::size_t>(chain.limits.axes); ++a)
      if (std::fabs(way_to(chain, i)[a]) / from_q62(chain.limits.axis[a].speed_q62) >
          0.9 * max_ticks)
        return true;
  return false;
}

/// Checks speed jumps: the setting for the corner plus the allowance for rounding.
inline void expect_jumps(const Chain& chain, const stepper::MotionState& from,
                         const stepper::Segment& s, std::size_t i) {
  const double beat = chain.limits.beat_ticks;
  for (int a = 0; a < chain.limits.axes; ++a) {
    const motion::AxisLimits& axis = chain.limits.axis[index(a)];
    const double jump = from_q62(s.axis[index(a)].speed_q62 - from.axis[index(a)].speed_q62) * beat;
    const double set = from_q62(axis.jump_q62) * beat;
    // Speeds are multiples of 2^-32 of the change of speed in a beat.
    const double unit = from_q62(axis.accel_q62) * beat * beat * 0x1p-32;
    ASSERT_LE(std::fabs(jump), (set + motion::rounding_jump_steps) * (1 + 1e-6) + 4 * unit) << a;
  }
  if (i == 0) return;
  const Vector before = way_to(chain, i - 1), after = way_to(chain, i);
  Vector speed{};
  for (std::size_t a = 0; a < speed.size(); ++a) speed[a] = from_q62(from.axis[a].speed_q62) * beat;
  if (length_of(chain, before) == 0 || length_of(chain, after) == 0) {
    ASSERT_TRUE(from.at_rest());
    return;
  }
  ASSERT_LE(length_of(chain, speed), real_corner_speed(chain, before, after, 3e-7) * (1 + 1e-5));
}

/// Checks speed, acceleration, line and no reversal every 97 ticks; the jerk at every tick.
inline void expect_on_line(const Chain& chain, const stepper::MotionState& from,
                           const stepper::Segment& s, std::size_t i, double& farthest) {
  const auto axes = static_cast<std::size_t>(chain.limits.axes);
  const Vector way = way_to(chain, i);
  double squares = 0;
  for (const double w : way) squares += w * w;
  std::vector<Vector> at((s.ticks + 96) / 97);
  for (std::size_t a = 0; a < axes; ++a) {
    const TickSum sum = sum_ticks(s.axis[a]);
    ASSERT_LE(sum.max_speed_q62, chain.limits.axis[a].speed_q62);
    ASSERT_LE(sum.max_accel_q62, chain.limits.axis[a].accel_q62);
    ASSERT_EQ(sum.sign_changes_outside_turns, 0);
    const double start = steps_of(from.axis[a].position_q64) -
                         (i == 0 ? 0.0 : static_cast<double>(chain.targets[i - 1].steps[a]));
    std::size_t tick = 0;
    JerkWatch watch(chain.limits.axis[a]);
    watch.allow_stairs(s.axis[a]);
    watch.tick(0);
    for_each_tick(s.axis[a], [&](Native position, std::int64_t, std::int64_t accel) {
      watch.tick(accel);
      if (tick % 97 == 0) at[tick / 97][a] = start + std::ldexp(static_cast<double>(position), -62);
      ++tick;
    });
    watch.tick(0);
    ASSERT_FALSE(watch.broken()) << "axis " << a << ": " << watch.worst() << " stairs";
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

inline void expect_valid(const Chain& chain, const ChainPlan& plan, long& ticks_to_sum,
                         double& farthest) {
  ASSERT_EQ(plan.result, Result::ok);
  ASSERT_EQ(plan.segments.size(), chain.targets.size());
  stepper::MotionState from = rest_at_zero();
  for (std::uint32_t i = 0; i < plan.segments.size(); ++i) {
    const stepper::Segment& s = plan.segments[i];
    SCOPED_TRACE(testing::Message() << "segment " << i);
    ASSERT_EQ(join_fault(chain.limits, from, s, plan.beats[i], true), Fault{});
    ASSERT_EQ(point_fault(chain, s, i, true), Fault{});
    ASSERT_EQ(limits_fault(chain.limits, from, s), Fault{});
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

}  // namespace lamplock::test
