// Limits from settings compared with the same quotients in long double.
#include "firmware/motion/profile/limits.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "firmware/motion/profile/reach.hpp"
#include "shared/work_space.hpp"
#include "tests/scale.hpp"

namespace lamplock::motion::limits_test {
namespace {

using Real = long double;
using settings::Id;

constexpr Real unit_q62 = 4611686018427387904.0L;  // 2^62
constexpr Real unit_q32 = 4294967296.0L;

Result limits_for(const settings::Values& values, std::uint32_t tick_q16, Limits& limits,
                  std::uint16_t& setting) {
  return make_limits(values, beat_ticks(values), tick_q16, limits, setting);
}

settings::Values random_values(std::mt19937_64& random) {
  settings::Values values;
  const auto any = [&](Id id, int axis, double lo, double hi) {
    std::uniform_real_distribution<double> power(std::log(lo), std::log(hi));
    values.set_milli(settings::for_axis(id, axis),
                     static_cast<std::int32_t>(std::exp(power(random)) * 1000));
  };
  any(Id::lamp_frequency, 0, 1, 5000);
  values.set_milli(Id::axes, 1000 * (1 + static_cast<std::int32_t>(random() % 4)));
  for (int a = 0; a < max_axes; ++a) {
    any(Id::steps_per_mm_x, a, 1, 2000);
    any(Id::max_rate_x, a, 10, 60'000);
    any(Id::acceleration_x, a, 10, 100'000);
    any(Id::travel_x, a, 1, 1000);
  }
  if (random() % 2 == 0) any(Id::shot_tolerance, 0, 0.1, 900);
  return values;
}

TEST(Limits, EqualTheSettingsInStepsAndTicks) {
  std::mt19937_64 random(21);
  int accepted = 0;
  for (int i = 0; i < test::scaled(3'000); ++i) {
    const settings::Values values = random_values(random);
    const std::uint32_t tick_q16 =
        full_tick_q16 - static_cast<std::uint32_t>(random() % 2 == 0 ? 0 : random() % 5536);
    Limits limits;
    std::uint16_t setting = 0;
    if (limits_for(values, tick_q16, limits, setting) != Result::ok) continue;
    ++accepted;
    ASSERT_EQ(limits.axes, values.whole(Id::axes));
    const StepLimits space = work_space(values);
    const Real tick =
        static_cast<Real>(tick_q16) / 65536 * 1e-6L;  // seconds, the shortest expected
    for (int a = 0; a < limits.axes; ++a) {
      const AxisLimits& axis = limits.axis[static_cast<std::size_t>(a)];
      const Real steps_per_mm = values.milli(Id::steps_per_mm_x, a) / 1e3L;
      const Real speed = values.milli(Id::max_rate_x, a) / 1e3L / 60 * steps_per_mm * tick;
      const Real accel = values.milli(Id::acceleration_x, a) / 1e3L * steps_per_mm * tick * tick;
      // Rounded down, by no more than a few units of 2^-62.
      ASSERT_LE(static_cast<Real>(axis.speed_q62), speed * unit_q62 * (1 + 1e-18L) + 1);
      ASSERT_GE(static_cast<Real>(axis.speed_q62), speed * unit_q62 * (1 - 1e-15L) - 3);
      ASSERT_LE(static_cast<Real>(axis.accel_q62), accel * unit_q62 * (1 + 1e-18L) + 1);
      ASSERT_GE(static_cast<Real>(axis.accel_q62), accel * unit_q62 * (1 - 1e-15L) - 3);
      ASSERT_EQ(axis.min_steps, space.min[static_cast<std::size_t>(a)]);
      ASSERT_EQ(axis.max_steps, space.max[static_cast<std::size_t>(a)]);
    }
  }
  EXPECT_GT(accepted, test::scaled(3'000) / 2);
}

/// Calls check(random, limits, axis number, its limits) for every axis of many random machines.
template <class Check>
void for_random_axes(std::uint64_t seed, Check check) {
  std::mt19937_64 random(seed);
  int accepted = 0;
  for (int i = 0; i < test::scaled(3'000); ++i) {
    Limits limits;
    std::uint16_t setting = 0;
    if (limits_for(random_values(random), full_tick_q16, limits, setting) != Result::ok) continue;
    ++accepted;
    for (int a = 0; a < limits.axes; ++a)
      ASSERT_NO_FATAL_FAILURE(check(random, limits, a, limits.axis[static_cast<std::size_t>(a)]));
  }
  EXPECT_GT(accepted, test::scaled(3'000) / 2);
}

TEST(Limits, PlanningLimitsLeaveTheReserveForWholeTicksAndNoMore) {
  for_random_axes(22, [](std::mt19937_64&, const Limits& limits, int, const AxisLimits& axis) {
    const Real n = limits.beat_ticks;
    const Real accel_room = 1 - axis.plan_accel_q62 / static_cast<Real>(axis.accel_q62);
    const Real speed_room = 1 - axis.plan_speed_q62 / static_cast<Real>(axis.speed_q62);
    ASSERT_GE(accel_room, 1.02L / n);
    ASSERT_LE(accel_room, 1.4L / n + 1e-5L + std::ldexp(40.0L, -axis.scale.bits));
    ASSERT_GE(speed_room, 4.8L / n);
    ASSERT_LE(speed_room, 5.1L / n + 1e-5L);
  });
}

TEST(Limits, NormalisedQuantitiesAreQuotientsByTheAcceleration) {
  for_random_axes(23, [](std::mt19937_64& random, const Limits& limits, int a,
                         const AxisLimits& axis) {
    const Real n = limits.beat_ticks;
    const Real accel = static_cast<Real>(axis.plan_accel_q62) / unit_q62 * n * n;
    const Real steps = static_cast<Real>(1 + random() % 1000);
    const Real q = steps / accel;
    if (q < 1e9L) {
      const Real got =
          axis.displacement_q32(static_cast<std::int64_t>(steps * unit_q32)) / unit_q32;
      ASSERT_NEAR(static_cast<double>(got / q), 1.0, 1e-9 + static_cast<double>(1 / unit_q32 / q));
    }
    const Real speed = static_cast<Real>(axis.plan_speed_q62) / unit_q62 * n / accel;
    const Real want = speed < max_beats_per_point ? speed : max_beats_per_point;
    const Real steps_per_beat = static_cast<Real>(axis.plan_speed_q62) / unit_q62 * n;
    const Real rounding = 2 / unit_q32 / want + 1 / unit_q32 / steps_per_beat;
    ASSERT_NEAR(static_cast<double>(axis.speed_q32 / unit_q32 / want), 1.0,
                1e-9 + static_cast<double>(rounding));
    // Conversely, the normalised limit is the planning speed.
    if (speed < max_beats_per_point) {
      ASSERT_NEAR(static_cast<double>(static_cast<Real>(limits.speed_q62(a, axis.speed_q32)) /
                                      static_cast<Real>(axis.plan_speed_q62)),
                  1.0, 1e-8 + static_cast<double>(rounding + n / axis.plan_speed_q62));
    }
  });
}

TEST(Limits, ShotToleranceDefaultsToHalfAStepOrFiveMicrometres) {
  settings::Values values;
  Limits limits;
  std::uint16_t setting = 0;
  values.set_milli(Id::steps_per_mm_x, 50'000);     // 20 um a step: half a step is more
  values.set_milli(Id::steps_per_mm_y, 1'000'000);  // 1 um a step: 5 um are more
  values.set_milli(Id::max_rate_y, 6'000'000);
  ASSERT_EQ(limits_for(values, full_tick_q16, limits, setting), Result::ok);
  EXPECT_EQ(limits.axis[0].shot_tolerance_q32, one_q32 / 2);
  EXPECT_EQ(limits.axis[1].shot_tolerance_q32, 5 * one_q32);
  values.set_milli(Id::shot_tolerance, 2'000);  // 2 um on every axis, below half a step too
  ASSERT_EQ(limits_for(values, full_tick_q16, limits, setting), Result::ok);
  EXPECT_EQ(limits.axis[0].shot_tolerance_q32, one_q32 / 10);
  EXPECT_EQ(limits.axis[1].shot_tolerance_q32, 2 * one_q32);
}

TEST(Limits, RefusesSettingsThatTicksCannotDoAndNamesThem) {
  Limits limits;
  std::uint16_t setting = 0;
  settings::Values values;
  values.set_milli(Id::steps_per_mm_y, 1'000'000);  // 1 m/s at 1000 step/mm: one step a tick
  EXPECT_EQ(limits_for(values, full_tick_q16, limits, setting), Result::bad_value);
  EXPECT_EQ(setting, 111);
  values.set_milli(Id::max_rate_y, 270'000'000);  // 4.5 steps a tick: more than the number holds
  EXPECT_EQ(limits_for(values, full_tick_q16, limits, setting), Result::bad_value);
  EXPECT_EQ(setting, 111);
  values = settings::Values();
  values.set_milli(Id::acceleration_z, 1);  // refused by the table: stays at its default
  ASSERT_EQ(limits_for(values, full_tick_q16, limits, setting), Result::ok);
  values.set_milli(Id::steps_per_mm_z, 1);
  values.set_milli(Id::acceleration_z, 1'000);
  EXPECT_EQ(limits_for(values, full_tick_q16, limits, setting), Result::bad_value);
  EXPECT_EQ(setting, 122);
  values = settings::Values();
  values.set_milli(Id::lamp_frequency, 5'000'000);
  ASSERT_EQ(limits_for(values, full_tick_q16, limits, setting), Result::ok);
  values.set_milli(Id::q_switch_delay, 60'000);  // with 150 us of pulse longer than a beat
  EXPECT_EQ(limits_for(values, full_tick_q16, limits, setting), Result::bad_value);
  EXPECT_EQ(setting, 903);
  EXPECT_EQ(make_limits(settings::Values(), 50, full_tick_q16, limits, setting), Result::bad_value);
  EXPECT_EQ(setting, 901);
}

TEST(Limits, BeatsAreTheNearestWholeNumberOfTicks) {
  settings::Values values;
  for (std::int32_t milli_hz : {1'000, 3'000, 7'000, 50'000, 99'999, 100'000, 300'000, 5'000'000}) {
    ASSERT_TRUE(values.set_milli(Id::lamp_frequency, milli_hz));
    EXPECT_EQ(beat_ticks(values), std::lround(1e9 / milli_hz)) << milli_hz;
  }
}

}  // namespace
}  // namespace lamplock::motion::limits_test
