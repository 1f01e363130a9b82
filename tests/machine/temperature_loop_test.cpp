// The loop that holds a temperature: limits at every step, no windup, the law of the documentation,
// failures of the sensor.
#include "firmware/machine/inputs/temperature_loop.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace lamplock::machine {
namespace {

using settings::Id;
using settings::Values;

constexpr std::int64_t one = TemperatureLoop::one_e11;
constexpr std::int64_t milli_percent = one / 100'000;

/// Any value in the range of the setting.
void set_any(Values& values, Id id) {
  const settings::Range& range = settings::range(id);
  const int milli = *rc::gen::inRange(range.min_milli, range.max_milli);
  values.put_milli(id, range.whole ? milli / 1000 * 1000 : milli);
}

Values any_values() {
  Values values;
  for (const Id id : {Id::loop_set_point, Id::loop_kp, Id::loop_ki, Id::loop_min, Id::loop_max,
                      Id::sensor_scale, Id::sensor_min, Id::sensor_max})
    set_any(values, id);
  values.put_milli(Id::loop, *rc::gen::element(1000, 2000));
  return values;
}

/// 1 V is 100 K; the set point is 1 V.
Values usual_values(std::int32_t kp_milli, std::int32_t ki_milli) {
  Values values;
  values.put_milli(Id::loop, 1000);
  values.put_milli(Id::loop_set_point, 1'000'000);
  values.put_milli(Id::loop_kp, kp_milli);
  values.put_milli(Id::loop_ki, ki_milli);
  values.put_milli(Id::sensor_scale, 100'000);
  return values;
}

std::uint16_t level_of(double volts) {
  return static_cast<std::uint16_t>(std::clamp(volts / 3.3 * 65'536, 0.0, 65'535.0));
}
double volts_of(std::uint16_t level) { return TemperatureLoop::microvolts(level) * 1e-6; }

RC_GTEST_PROP(TemperatureLoop, StaysInsideItsLimitsAtEveryStep, ()) {
  const Values values = any_values();
  TemperatureLoop loop;
  const auto steps = *rc::gen::container<std::vector<std::pair<std::uint16_t, bool>>>(
      rc::gen::pair(rc::gen::arbitrary<std::uint16_t>(), rc::gen::arbitrary<bool>()));
  for (const auto& [level, lit] : steps) {
    const std::int64_t before = loop.scale_e11();
    loop.measure(level);
    loop.step(values, lit);
    RC_ASSERT(loop.scale_e11() >= milli_percent * values.milli(Id::loop_min));
    RC_ASSERT(loop.scale_e11() <= milli_percent * values.milli(Id::loop_max));
    RC_ASSERT(loop.scale_q15() <= 2 * stepper::full_scale_q15);
    if (!lit) RC_ASSERT(loop.scale_e11() == before);
  }
}

/// However long it was at a limit, the first step that points away leaves it.
RC_GTEST_PROP(TemperatureLoop, DoesNotWindUp, (bool cold)) {
  const Values values = usual_values(*rc::gen::inRange(0, 5000), *rc::gen::inRange(1000, 900'000));
  TemperatureLoop loop;
  const int saturated = *rc::gen::inRange(1, 5000);
  for (int i = 0; i < 2000 + saturated; ++i) {
    loop.measure(level_of(cold ? 0.2 : 3));
    loop.step(values, true);
  }
  const std::int64_t limit = milli_percent * values.milli(cold ? Id::loop_max : Id::loop_min);
  RC_ASSERT(loop.scale_e11() == limit);
  loop.measure(level_of(cold ? 1.1 : 0.9));
  loop.step(values, true);
  const bool has_left = cold ? loop.scale_e11() < limit : loop.scale_e11() > limit;
  RC_ASSERT(has_left);
}

/// u = 1 + Ki integral(r - y) - Kp y, from equilibrium, in floating point. The loop rounds each
/// temperature down to 1 mK, and its factor from nK to mK is 8e-6 too large: 0.016 mK of 2 K.
RC_GTEST_PROP(TemperatureLoop, IsTheControllerOfTheDocumentation, ()) {
  const Values values = usual_values(*rc::gen::inRange(0, 2000), *rc::gen::inRange(0, 20'000));
  const bool feed = *rc::gen::arbitrary<bool>();
  Values used = values;
  if (feed) used.put_milli(Id::loop, 2000);
  TemperatureLoop loop;
  loop.measure(level_of(1));
  loop.rest(used);
  const double start_k = (volts_of(level_of(1)) - 1) * 100;
  double integral = 0;
  for (int i = 0; i < 200; ++i) {
    const std::uint16_t level = level_of(*rc::gen::inRange(980, 1020) / 1000.0);
    loop.measure(level);
    loop.step(used, true);
    const double above_k = (volts_of(level) - 1) * 100;
    integral -= above_k * 1e-3;
    const double ki = used.milli(Id::loop_ki) * 1e-5, kp = used.milli(Id::loop_kp) * 1e-5;
    const double change = ki * integral - kp * (above_k - start_k);
    const double wanted = 1 + (feed ? -change : change);
    const double is = static_cast<double>(loop.scale_e11()) / static_cast<double>(one);
    constexpr double rounding_k = 1.02e-3;
    RC_ASSERT(std::abs(is - wanted) <= rounding_k * (ki * 1e-3 * (i + 1) + kp));
  }
}

TEST(TemperatureLoop, ScalesPowersExactlyAndNeverAboveFull) {
  for (std::uint32_t power = 0; power < 65'536; ++power) {
    const auto p = static_cast<std::uint16_t>(power);
    ASSERT_EQ(stepper::scaled_power(p, stepper::full_scale_q15), power);
    ASSERT_EQ(stepper::scaled_power(p, stepper::full_scale_q15 / 2), power / 2);
    ASSERT_EQ(stepper::scaled_power(p, 2 * stepper::full_scale_q15),
              std::min<std::uint32_t>(2 * power, 65'535));
  }
  TemperatureLoop loop;
  EXPECT_EQ(loop.scale_q15(), stepper::full_scale_q15);
  EXPECT_EQ(loop.percent(), 100u);
}

RC_GTEST_PROP(TemperatureLoop, FailsAfterAMillisecondOutOfRange, (bool below)) {
  Values values;  // 0.1 to 3.2 V
  TemperatureLoop loop;
  std::uint32_t clock = *rc::gen::arbitrary<std::uint32_t>();
  const auto look = [&](double volts, std::uint32_t us, bool runs) {
    clock += us * clocks_per_us;
    loop.measure(level_of(volts));
    loop.watch(values, clock, runs);
    return loop.failed();
  };
  look(1, 0, true);
  const double bad = below ? 0.05 : 3.25;
  RC_ASSERT(!look(bad, *rc::gen::inRange(1u, 999u), true));
  RC_ASSERT(!look(1, 100, true));
  look(bad, 1, true);
  RC_ASSERT(look(bad, 1000, true));
  // It remains while the machine brakes and is held, whatever the sensor.
  RC_ASSERT(look(1, 100'000, false));
  RC_ASSERT(look(1, 1, false));
  RC_ASSERT(!look(1, 1, true));
}

TEST(TemperatureLoop, HasAPeriodOfAMillisecond) {
  TemperatureLoop loop;
  int steps = 0;
  const std::uint32_t start = 0xffff'0000u;
  loop.take_period(start);
  for (std::uint32_t us = 1; us <= 100'000; us += 37)
    if (loop.take_period(start + us * clocks_per_us)) ++steps;
  EXPECT_NEAR(steps, 100, 1);
  EXPECT_TRUE(loop.take_period(start + 200'000 * clocks_per_us));
  EXPECT_FALSE(loop.take_period(start + 200'100 * clocks_per_us));
}

}  // namespace
}  // namespace lamplock::machine
