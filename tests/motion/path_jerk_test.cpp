// Paths with limits of jerk: random ones checked against every limit at every tick, their cost, and
// that braking from every point stays inside the work space.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <memory>
#include <random>

#include "firmware/motion/path/planner.hpp"
#include "firmware/motion/profile/pulse.hpp"
#include "tests/motion/path_checks.hpp"
#include "tests/scale.hpp"

namespace lamplock::motion::path_jerk_test {
namespace {

using test::Chain;
using test::ChainPlan;

/// Checks a brake from the end of a segment, as made if the next one is not run.
void expect_brake_inside(const Chain& chain, const Segment& s) {
  const Segment brake = make_brake(s.end, chain.limits);
  ASSERT_TRUE(stays_inside(brake, s.end, chain.limits));
}

TEST(PathJerk, EveryPlanIsExactKeepsEveryLimitAndCanStop) {
  const auto planner = std::make_unique<PathPlanner>();
  double farthest = 0;
  int given_up = 0, with_ramps = 0, segments = 0;
  const int chains = test::scaled(400);
  for (int i = 0; i < chains; ++i) {
    SCOPED_TRACE(testing::Message() << "chain " << i);
    std::mt19937_64 random(static_cast<std::uint64_t>(i) + 7700);
    const Chain chain = test::random_path(random, 100, true);
    if (test::has_endless_line(chain, 1 << 26)) continue;
    const ChainPlan plan = test::plan_path(chain, *planner);
    if (plan.result != Result::ok) {
      // The machine brakes and continues from rest, if there is a plan.
      if (plan.segments.empty() || plan.segments.back().end.at_rest()) {
        ADD_FAILURE() << "from rest after " << plan.segments.size();
        continue;
      }
      ++given_up;
      continue;
    }
    long ticks_to_sum = 60'000;
    ASSERT_NO_FATAL_FAILURE(test::expect_valid(chain, plan, ticks_to_sum, farthest));
    for (const Segment& s : plan.segments) {
      ASSERT_NO_FATAL_FAILURE(expect_brake_inside(chain, s));
      with_ramps += s.axis[0].lead_ramp != 0 || s.axis[0].tail_ramp != 0;
      ++segments;
    }
  }
  EXPECT_GT(with_ramps, segments / 4);
  std::cout << given_up << " of " << chains << " given up, " << with_ramps << " of " << segments
            << " with ramps, farthest " << farthest << "\n";
}

}  // namespace
}  // namespace lamplock::motion::path_jerk_test
