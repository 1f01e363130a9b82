// Runs of motors shared by two axes: sums and differences tick by tick, reversals, rest, and the
// inverse.
#include "firmware/stepper/motor_runs.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/scale.hpp"

namespace lamplock::stepper {
namespace {

constexpr AxisPair core{AxisPair::Kind::core, 0, 1}, ganged{AxisPair::Kind::ganged, 1, 3};

class RandomRuns {
 public:
  explicit RandomRuns(std::uint64_t seed) : random_(seed) {}

  std::uint64_t bits() { return random_(); }
  std::int64_t between(std::int64_t low, std::int64_t high) {
    return std::uniform_int_distribution<std::int64_t>(low, high)(random_);
  }
  /// Up to 0.4 steps per tick, with accelerations that reverse it in some thousand ticks or never.
  AxisRun run() {
    const std::int64_t max_rate = std::int64_t{1} << between(20, 55);
    const std::int64_t max_accel = max_rate / between(100, 20'000);
    const Int128 step = Int128(between(-100'000, 100'000)) << 64;
    return {step + Int128(between(0, std::int64_t{1} << 62)), between(-max_rate, max_rate),
            between(-max_accel, max_accel)};
  }

 private:
  std::mt19937_64 random_;
};

AxisRun at_rest(std::int32_t step) { return {middle_of_step(step), 0, 0}; }

TEST(MotorRuns, RestInTheMiddleOfTheirSteps) {
  RandomRuns random(1);
  for (int i = 0; i < test::scaled(200); ++i) {
    const auto x = static_cast<std::int32_t>(random.between(-1 << 20, 1 << 20));
    const auto y = static_cast<std::int32_t>(random.between(-1 << 20, 1 << 20));
    const AxisRun u = at_rest(x), v = at_rest(y);
    EXPECT_EQ(motor_run(core, u, v, false).position_q64, middle_of_step(x + y));
    EXPECT_EQ(motor_run(core, u, v, true).position_q64, middle_of_step(x - y));
    EXPECT_EQ(motor_run(ganged, u, v, false).position_q64, middle_of_step(x));
    EXPECT_EQ(motor_run(ganged, u, v, true).position_q64, middle_of_step(x + y));
  }
}

TEST(MotorRuns, AreSumsAndDifferencesAtEveryTickAndInvert) {
  RandomRuns random(2);
  for (int i = 0; i < test::scaled(500); ++i) {
    const AxisRun u = random.run(), v = random.run();
    const auto n = static_cast<std::uint32_t>(random.between(0, 5000));
    for (const AxisPair& pair : {core, ganged}) {
      const AxisRun first = motor_run(pair, u, v, false), second = motor_run(pair, u, v, true);
      const Int128 x = u.position_after(n), y = v.position_after(n) - middle_of_step(0);
      const bool is_core = pair.kind == AxisPair::Kind::core;
      EXPECT_EQ(first.position_after(n), is_core ? x + y : x);
      EXPECT_EQ(second.position_after(n), is_core ? x - y : x + y);
      const AxisRuns back = axis_runs(pair, first, second);
      for (const auto& [was, is] : {std::pair{u, back.first}, std::pair{v, back.second}}) {
        EXPECT_EQ(is.position_q64, was.position_q64);
        EXPECT_EQ(is.rate_q62, was.rate_q62);
        EXPECT_EQ(is.accel_q62, was.accel_q62);
      }
    }
  }
}

TEST(MotorRuns, KeepTheirDirectionUntilTheyReverse) {
  RandomRuns random(3);
  int turned = 0;
  for (int i = 0; i < test::scaled(2000); ++i) {
    const AxisRun run = motor_run(core, random.run(), random.run(), i % 2 != 0);
    const auto n = static_cast<std::uint32_t>(random.between(1, 3000));
    const bool back = run.backwards();
    std::uint32_t ticks = 0;
    while (ticks < n && (back ? run.rate_after(ticks) <= 0 : run.rate_after(ticks) >= 0)) ++ticks;
    ASSERT_EQ(ticks_one_way(run, n), ticks) << "run " << i;
    if (ticks != n) ++turned;
  }
  EXPECT_GT(turned, test::scaled(2000) / 20);
}

/// Positions of motors, loads and axes at rest: both directions.
TEST(Kinematics, PlacesAreConvertedBothWays) {
  RandomRuns random(4);
  settings::Values values;
  for (const int xy : {0, 1}) {
    for (const int gang : {0, 1, 2, 3}) {
      values.set_milli(settings::Id::kinematics, xy * 1000);
      values.set_milli(settings::Id::ganged_axis, gang * 1000);
      const Kinematics kinematics(values);
      const bool contradicts = xy == 1 && (gang == 1 || gang == 2);
      EXPECT_EQ(broken_kinematics(values), contradicts ? 966 : 0);
      EXPECT_EQ(kinematics.core_xy(), xy == 1);
      EXPECT_EQ(kinematics.ganged_axis(), contradicts ? -1 : gang - 1);
      for (int i = 0; i < test::scaled(50); ++i) {
        StepPosition loads{};
        for (std::int32_t& load : loads)
          load = static_cast<std::int32_t>(random.between(-1 << 20, 1 << 20));
        EXPECT_EQ(kinematics.loads_of(kinematics.motors_of_loads(loads)), loads);
        StepPosition axes = loads;
        if (kinematics.ganged_axis() >= 0) axes[3] -= axes[index(kinematics.ganged_axis())];
        EXPECT_EQ(kinematics.motors_of(axes), kinematics.motors_of_loads(loads));
      }
    }
  }
}

}  // namespace
}  // namespace lamplock::stepper
