// Lines at very low feeds: they end, in the time of their length and feed.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/motion/line_machine.hpp"
#include "tests/motion/line_paths.hpp"
#include "tests/scale.hpp"

namespace lamplock::test {
namespace {

/// Lines of some seconds each, at 0.001 to 10 mm/min, mostly less than a step long; `seconds` is
/// the time of their lengths and feeds.
std::vector<LineTarget> slow_lines(LineRandom& random, const LineMachine& m, double& seconds) {
  std::normal_distribution<double> normal;
  std::vector<LineTarget> targets;
  LineTarget before;
  const auto count = 1 + random() % 6;
  LineVector at_mm{};
  for (std::size_t i = 0; i < count; ++i) {
    LineTarget t;
    t.feed_um_min = static_cast<std::uint32_t>(std::ceil(between(random, 1, 10'000)));
    const double mm_s = t.feed_um_min / 60e3, length_mm = between(random, 0.1, 5) * mm_s;
    LineVector direction{};
    double squares = 0;
    for (std::size_t a = 0; a < static_cast<std::size_t>(m.axes); ++a) {
      direction[a] = normal(random);
      squares += direction[a] * direction[a];
    }
    double moved_2 = 0;
    for (std::size_t a = 0; a < static_cast<std::size_t>(m.axes); ++a) {
      at_mm[a] += length_mm * direction[a] / std::sqrt(squares);
      put_place(t, static_cast<int>(a), at_mm[a] * m.steps_mm[a]);
      const double moved_mm = (steps_at(t, a) - steps_at(before, a)) / m.steps_mm[a];
      moved_2 += moved_mm * moved_mm;
    }
    t.timed = random() % 4 == 0;
    if (t.timed) t.time_us = static_cast<std::uint32_t>(std::sqrt(moved_2) / mm_s * 1e6);
    if (t.timed && t.time_us == 0) continue;
    t.exact_stop = random() % 4 == 0;
    seconds += std::sqrt(moved_2) / mm_s;
    before = t;
    targets.push_back(t);
  }
  return targets;
}

void run_slow_path(std::uint64_t seed, bool jerk) {
  LineRandom random(seed);
  LineMachine m = random_machine(random);
  if (jerk) limit_jerk(random, m);
  double seconds = 0;
  const std::vector<LineTarget> targets = slow_lines(random, m, seconds);
  if (targets.empty()) return;
  LineRig rig(m);
  rig.check_ticks(50'000);
  const std::uint32_t percent =
      random() % 2 == 0 ? 100 : 10 + static_cast<std::uint32_t>(random() % 191);
  rig.planner().set_feed_percent(percent);
  seconds *= 100.0 / percent;
  for (const LineTarget& t : targets) ASSERT_TRUE(rig.push(t));
  while (rig.step() && rig.seconds() < 2 * seconds + 10) {
  }
  ASSERT_NO_FATAL_FAILURE(expect_at_end(rig));
  EXPECT_TRUE(rig.planner().idle());
  // Changes of speed are short: within a millisecond without limits of jerk.
  EXPECT_NEAR(rig.seconds(), seconds, 0.01 * seconds + (jerk ? 0.5 : 0.002));
}

TEST(LinePlanner, EndsSlowLinesInTheTimeOfTheirFeed) {
  for (int i = 0; i < scaled(200); ++i) {
    SCOPED_TRACE(testing::Message() << "path " << i);
    ASSERT_NO_FATAL_FAILURE(run_slow_path(static_cast<std::uint64_t>(i) + 20'000, i % 4 == 3));
  }
}

}  // namespace
}  // namespace lamplock::test
