// Rows of points: run-ups where they save beats, and no change elsewhere.
#include "firmware/motion/free/run_up.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "tests/motion/chain.hpp"
#include "tests/motion/plan_checks.hpp"

namespace lamplock::motion::run_up_test {
namespace {

using test::Chain;

/// Rows of `count` points, `spacing_mm` apart, in alternating directions.
Chain rows(double lamp_hz, double accel_m_s2, double spacing_mm, int count, int rows) {
  constexpr double steps_per_mm = 200;
  Chain chain;
  chain.limits = test::limits_of(test::machine_settings(lamp_hz, accel_m_s2, 1, 3, steps_per_mm));
  for (int row = 0; row < rows; ++row)
    for (int i = 0; i < count; ++i) {
      wire::Target target;
      target.steps[0] = static_cast<std::int32_t>(
          std::lround((row % 2 == 0 ? i : count - 1 - i) * spacing_mm * steps_per_mm));
      target.steps[1] = static_cast<std::int32_t>(std::lround(row * 4 * spacing_mm * steps_per_mm));
      chain.targets.push_back(target);
    }
  return chain;
}

double beats_per_point(const Chain& chain) {
  const auto planner = std::make_unique<Planner>();
  const test::ChainPlan plan = test::plan_chain(chain, *planner);
  EXPECT_EQ(plan.result, Result::ok);
  long ticks_to_sum = 1'000'000;
  EXPECT_EQ(test::plan_fault(chain, plan, ticks_to_sum), test::Fault{});
  return static_cast<double>(plan.total_beats()) / static_cast<double>(chain.targets.size());
}

TEST(RunUp, LongRowsTakeOneBeatAPoint) {
  // Without run-ups 3.02, 5.04 and 2.03: the climb ends where d <= k (k + 1) (k + 1/2).
  EXPECT_LT(beats_per_point(rows(4000, 10, 0.025, 1000, 3)), 1.15);
  EXPECT_LT(beats_per_point(rows(4000, 10, 0.1, 1000, 3)), 1.6);
  EXPECT_LT(beats_per_point(rows(100, 2, 1, 100, 3)), 1.2);
}

TEST(RunUp, ShortRowsHaveNone) {
  // Full speed after 160 beats costs 400 beats; fifty points would save four beats each.
  const Chain chain = rows(4000, 10, 0.1, 50, 3);
  const auto planner = std::make_unique<Planner>();
  const test::ChainPlan plan = test::plan_chain(chain, *planner);
  ASSERT_EQ(plan.result, Result::ok);
  EXPECT_LT(*std::max_element(plan.beats.begin(), plan.beats.end()), 60);
}

TEST(RunUp, IsOmittedWithoutRoom) {
  Chain chain = rows(4000, 10, 0.025, 600, 1);
  const double free = beats_per_point(chain);
  // The work space ends just past the row: there is no room to brake from full speed.
  chain.limits.axis[0].min_steps = -2;
  chain.limits.axis[0].max_steps = 600 * 5 + 2;
  const double tight = beats_per_point(chain);
  EXPECT_LT(free, 1.5);
  EXPECT_GT(tight, free);
  EXPECT_LT(tight, 3.5);
}

TEST(RunUp, ThePlanDoesNotDependOnTheNumberOfKnownPoints) {
  const Chain chain = rows(1000, 10, 0.1, 400, 2);
  const auto planner = std::make_unique<Planner>();
  const test::ChainPlan all = test::plan_chain(chain, *planner);
  const test::ChainPlan few = test::plan_chain(chain, *planner, {}, 1);
  ASSERT_EQ(all.result, Result::ok);
  EXPECT_EQ(all.beats, few.beats);
}

TEST(RunUp, SteadyMovesHaveNoAcceleration) {
  const Chain chain = rows(4000, 10, 0.025, 1000, 1);
  const auto planner = std::make_unique<Planner>();
  const test::ChainPlan plan = test::plan_chain(chain, *planner);
  ASSERT_EQ(plan.result, Result::ok);
  const auto steady = std::count_if(
      plan.segments.begin(), plan.segments.end(),
      [](const Segment& s) { return s.axis[0].lead_ticks == 0 && s.axis[0].speed_q62 != 0; });
  EXPECT_GT(steady, 900);
}

}  // namespace
}  // namespace lamplock::motion::run_up_test
