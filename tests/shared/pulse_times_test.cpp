// The lattice of pulses: whole ticks that last long enough, and no more of them than needed.
#include "shared/pulse_times.hpp"

#include <gtest/gtest.h>

#include "firmware/motion/profile/limits.hpp"

namespace lamplock {
namespace {

using settings::Id;

settings::Values pulses_of(std::int32_t high_ns, std::int32_t low_ns) {
  settings::Values values;
  EXPECT_TRUE(values.set_milli(Id::step_pulse, high_ns));
  EXPECT_TRUE(values.set_milli(Id::step_low, low_ns));
  return values;
}

TEST(PulseTimes, AreWholeTicksOfTheShortestLength) {
  for (std::int32_t high = 400; high <= 10'000; high += 70)
    for (std::int32_t low = 300; low <= 10'000; low += 90) {
      const PulseTimes times = pulse_times(pulses_of(high, low));
      const std::uint32_t rest_ns = (times.period_ticks - times.high_ticks) * min_moving_tick_ns -
                                    (times.high_ticks == 0 ? min_moving_tick_ns - short_low_ns : 0);
      ASSERT_GE(rest_ns, static_cast<std::uint32_t>(low));
      ASSERT_TRUE(times.period_ticks == times.high_ticks + 1 ||
                  rest_ns - min_moving_tick_ns < static_cast<std::uint32_t>(low));
      const std::uint32_t high_ns =
          times.high_ticks == 0 ? short_pulse_ns : times.high_ticks * min_moving_tick_ns;
      ASSERT_GE(high_ns, static_cast<std::uint32_t>(high));
    }
  EXPECT_EQ(pulse_times({}), (PulseTimes{0, 1}));
  EXPECT_EQ(pulse_times(pulses_of(500, 500)), (PulseTimes{0, 2}));
  EXPECT_EQ(pulse_times(pulses_of(510, 300)), (PulseTimes{1, 2}));
  EXPECT_EQ(pulse_times(pulses_of(2500, 2500)), (PulseTimes{3, 6}));
  EXPECT_EQ(pulse_times(pulses_of(10'000, 10'000)), (PulseTimes{12, 24}));
}

/// The planner takes exactly the rates up to the reported one.
TEST(PulseTimes, SetTheHighestRateThatThePlannerTakes) {
  for (const std::int32_t pulse : {400, 500, 510, 2500, 7100, 10'000})
    for (const std::int32_t steps_milli : {80'000, 200'000, 333'333, 2'500'000}) {
      settings::Values values = pulses_of(pulse, pulse);
      for (int axis = 0; axis < 3; ++axis)
        values.put_milli(settings::for_axis(Id::steps_per_mm_x, axis), steps_milli);
      const std::int64_t most = max_rate_milli(values, 1);
      motion::Limits limits;
      for (const std::int64_t rate : {most, most + 1}) {
        if (rate > settings::range(Id::max_rate_y).max_milli) continue;
        for (int axis = 0; axis < 3; ++axis)
          values.put_milli(settings::for_axis(Id::max_rate_x, axis), 60'000);
        values.put_milli(Id::max_rate_y, static_cast<std::int32_t>(rate));
        std::uint16_t setting = 0;
        const Result result =
            motion::make_limits(values, beat_ticks(values), full_tick_q16, limits, setting);
        ASSERT_EQ(result == Result::ok, rate == most) << pulse << " ns, " << rate;
        ASSERT_EQ(settings::rate_excess(values).axis, rate == most ? -1 : 1);
        if (rate == most) continue;
        EXPECT_EQ(setting, settings::number(Id::max_rate_y));
        EXPECT_EQ(settings::rate_excess(values).max_milli, most);
      }
    }
}

/// A tick that follows a slow lamp is longer: the axis makes no more steps in it.
TEST(PulseTimes, LongerTicksDoNotRaiseTheStepsPerTick) {
  settings::Values values = pulses_of(2500, 2500);
  values.put_milli(Id::max_rate_x, static_cast<std::int32_t>(max_rate_milli(values, 0)));
  for (int axis = 1; axis < 3; ++axis)
    values.put_milli(settings::for_axis(Id::max_rate_x, axis), values.milli(Id::max_rate_x));
  motion::Limits limits;
  std::uint16_t setting = 0;
  const std::uint32_t longest_q16 = full_tick_q16 / 100 * 115;
  ASSERT_EQ(motion::make_limits(values, beat_ticks(values), longest_q16, limits, setting),
            Result::ok);
  EXPECT_LE(limits.axis[0].speed_q62, one_q62 / 100 * 98 / 6 + 1);
}

}  // namespace
}  // namespace lamplock
