// The line planner with limited jerk.
#include <gtest/gtest.h>

#include "tests/motion/line_machine.hpp"
#include "tests/motion/line_paths.hpp"
#include "tests/motion/line_reference.hpp"
#include "tests/scale.hpp"

namespace lamplock::test {
namespace {

TEST(LineJerk, RandomPathsKeepLimits) {
  for (int i = 0; i < scaled(12); ++i) {
    SCOPED_TRACE(testing::Message() << "path " << i);
    LineRandom random(static_cast<std::uint64_t>(i) + 9700);
    LineMachine m = random_machine(random);
    limit_jerk(random, m);
    const auto targets = random_lines(random, m, 1 + random() % 200, between(random, 0.02, 20));
    LineRig rig(m);
    rig.check_ticks(50'000);
    rig.stream(targets);
    ASSERT_NO_FATAL_FAILURE(expect_at_end(rig));
    ASSERT_GE(rig.seconds(), LineReference(m, targets, false).seconds() * (1 - 1e-5));
  }
}

TEST(LineJerk, AnSCurveTakesTheTimeOfItsRise) {
  // l/v + v/a + a/j; each pulse is rounded up to a slice and costs some more.
  for (const double rise_s : {0.0005, 0.001, 0.002, 0.004}) {
    LineMachine m;
    m.accel_mm_s2.fill(1000);
    m.jerk_m_s3.fill(1 / rise_s);
    LineRig rig(m);
    LineTarget t;
    t.steps[0] = 20'000;
    t.feed_um_min = 6'000'000;
    rig.stream({t});
    ASSERT_NO_FATAL_FAILURE(expect_at_end(rig));
    const double least = 1.0 + 0.1 + rise_s;
    EXPECT_GE(rig.seconds(), least);
    EXPECT_LE(rig.seconds(), least + 0.1 * rise_s / (0.008 - rise_s) + 0.005) << rise_s;
  }
}

}  // namespace
}  // namespace lamplock::test
