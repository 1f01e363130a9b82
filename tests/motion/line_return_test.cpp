// The line planner with late segments: it returns to a mark from the machine's position.
#include <gtest/gtest.h>

#include "tests/motion/line_machine.hpp"
#include "tests/motion/line_paths.hpp"
#include "tests/motion/line_reference.hpp"
#include "tests/scale.hpp"

namespace lamplock::test {
namespace {

/// Checks that no line is skipped: in order, and every line with a length reaches its end.
void expect_all_lines(const LineRig& rig) {
  const auto is_nothing = [&](std::uint32_t line) {
    const StepPosition from = line == 0 ? StepPosition{} : rig.targets()[line - 1].steps;
    return rig.targets()[line].steps == from;
  };
  std::uint32_t line = 0;
  for (const LineSegment& s : rig.segments()) {
    if (s.settles) continue;
    while (line < s.line && is_nothing(line)) ++line;
    ASSERT_EQ(s.line, line);
    if (s.ends_line) ++line;
  }
}

class Returns : public testing::TestWithParam<bool> {};

TEST_P(Returns, AtRandomTimesLimitsAreKeptAndTheEndIsExact) {
  for (int i = 0; i < scaled(GetParam() ? 4 : 12); ++i) {
    SCOPED_TRACE(testing::Message() << "path " << i);
    LineRandom random(static_cast<std::uint64_t>(i) + 9900);
    LineMachine m = random_machine(random);
    if (GetParam()) limit_jerk(random, m);
    const auto targets = random_lines(random, m, 20 + random() % 100, between(random, 0.02, 10));
    LineRig rig(m);
    rig.check_ticks(20'000);
    std::size_t pushed = 0;
    const std::uint64_t every = 3 + random() % 100;
    for (bool going = true; going;) {
      while (pushed < targets.size() && rig.push(targets[pushed])) ++pushed;
      if (random() % (2 * every) == 0)
        rig.planner().set_feed_percent(static_cast<std::uint32_t>(between(random, 20, 250)));
      // After the last line no segment can be late: it ends at rest, without a brake.
      if (random() % every == 0 && !rig.planner().idle()) {
        rig.miss(random() % 9, [&] {
          if (random() % 4 == 0) rig.planner().set_feed_percent(50);
          if (random() % 4 == 0) rig.planner().hold();
        });
        if (random() % 4 == 0) rig.miss(random() % 9);
        if (rig.planner().held()) {
          ASSERT_FALSE(rig.step());
          rig.planner().resume();
        }
      }
      going = rig.step() || pushed < targets.size();
      ASSERT_FALSE(testing::Test::HasFatalFailure());
    }
    ASSERT_TRUE(rig.planner().idle());
    ASSERT_NO_FATAL_FAILURE(expect_at_end(rig));
    ASSERT_NO_FATAL_FAILURE(expect_all_lines(rig));
  }
}

INSTANTIATE_TEST_SUITE_P(Jerk, Returns, testing::Bool());

/// The rest of a path from a place on it; its first line is only a start at that place.
std::vector<LineTarget> rest_of(const motion::LinePlace& place,
                                const std::vector<LineTarget>& targets, std::size_t first) {
  LineTarget here;
  here.rapid = here.exact_stop = true;
  static_cast<motion::LinePlace&>(here) = place;
  std::vector<LineTarget> rest{here};
  rest.insert(rest.end(), targets.begin() + static_cast<std::ptrdiff_t>(first), targets.end());
  return rest;
}

TEST(LineReturn, LaterCornersAreJudgedFromThePlaceWhereItLeftThePath) {
  for (int i = 0; i < scaled(30); ++i) {
    SCOPED_TRACE(testing::Message() << "path " << i);
    LineRandom random(static_cast<std::uint64_t>(i) + 9950);
    const LineMachine m = random_machine(random);
    const auto targets = random_lines(random, m, 30, between(random, 0.1, 5));
    LineRig rig(m);
    // The ring contains all lines, or the current one and little more.
    const std::size_t known = random() % 2 == 0 ? targets.size() : 1 + random() % 2;
    for (std::size_t k = 0; k < known; ++k) rig.push(targets[k]);
    const std::uint64_t count = 1 + random() % (known > 2 ? 40 : 4);
    for (std::uint64_t k = 0; k < count; ++k) rig.step();
    if (rig.segments().empty()) continue;  // lines of no length
    const LineSegment last = rig.segments().back();
    const std::size_t first = last.line + (last.ends_line ? 1 : 0);
    rig.miss(random() % 9);
    std::size_t before = rig.segments().size();
    stepper::MotionState here = rig.at();
    for (std::size_t k = known; k < targets.size(); ++k) rig.push(targets[k]);
    rig.run();
    ASSERT_NO_FATAL_FAILURE(expect_at_end(rig));
    for (; before < rig.segments().size() && rig.segments()[before].settles; ++before)
      here = rig.segments()[before].segment.end;
    const LineReference best(m, rest_of(motion::place_of(here), targets, first), false);
    for (std::size_t k = before; k < rig.segments().size(); ++k) {
      const LineSegment& s = rig.segments()[k];
      if (!s.ends_line) continue;
      const auto line = static_cast<std::uint32_t>(s.line - first + 1);
      ASSERT_LE(rig.speed_mm_s(s), best.end_mm_s(line) * (1 + 1e-4) + 0.05 * rig.tick_of_accel());
    }
  }
}

/// A straight, dark move back, with any interruptions, and then on along the path.
TEST(LineReturn, ReturnsDarkToThePlaceWhereItLeftThePath) {
  int ways = 0;
  for (int i = 0; i < scaled(40); ++i) {
    SCOPED_TRACE(testing::Message() << "path " << i);
    LineRandom random(static_cast<std::uint64_t>(i) + 9930);
    LineMachine m = random_machine(random);
    if (i % 3 == 0) limit_jerk(random, m);
    auto targets = random_lines(random, m, 60, between(random, 0.5, 20));
    for (LineTarget& t : targets) {
      t.laser = random() % 2 == 0 ? motion::LinePower::constant : motion::LinePower::proportional;
      t.power = 40'000;
    }
    LineRig rig(m);
    rig.check_ticks(20'000);
    for (const LineTarget& t : targets) rig.push(t);
    const std::uint64_t count = 1 + random() % 60;
    for (std::uint64_t k = 0; k < count; ++k) rig.step();
    const stepper::MotionState left = rig.at();
    if (rig.planner().idle()) continue;
    rig.miss(random() % 9);
    // Late again during the move back, or held there.
    std::size_t before = rig.segments().size();
    for (std::uint64_t more = random() % 3; more != 0; --more) {
      while (random() % 3 != 0 && rig.step() && rig.segments().back().settles) {
      }
      if (rig.segments().size() > before && !rig.segments().back().settles) break;
      rig.miss(random() % 5, [&] {
        if (random() % 2 == 0) rig.planner().hold();
      });
      ASSERT_EQ(rig.step(), !rig.planner().held());
      rig.planner().resume();
    }
    while (rig.segments().size() == before || rig.segments().back().settles) {
      ASSERT_TRUE(rig.step());
      ASSERT_FALSE(testing::Test::HasFatalFailure());
    }
    for (; rig.segments()[before].settles; ++before) {
      const LineSegment& s = rig.segments()[before];
      ++ways;
      ASSERT_FALSE(s.ends_line || s.segment.shines);
      ASSERT_EQ(s.power_start + s.power_cruise + s.power_end, 0);
    }
    // The place where it left the path, except for the resolution of a place.
    const stepper::Segment& on = rig.segments()[before].segment;
    for (std::size_t a = 0; a < static_cast<std::size_t>(m.axes); ++a) {
      const Int128 begin =
          on.end.axis[a].position_q64 - (stepper::displacement_q62(on.axis[a]) << 2);
      const Int128 off = begin - left.axis[a].position_q64;
      ASSERT_LT(std::fabs(std::ldexp(static_cast<double>(native(off)), -64)), a < 2 ? 0.3 : 0.04)
          << a;
    }
  }
  EXPECT_GT(ways, 30);
}

TEST(LineReturn, ATimedLineTakesItsRemainingTime) {
  for (int i = 0; i < scaled(20); ++i) {
    SCOPED_TRACE(testing::Message() << "path " << i);
    LineRandom random(static_cast<std::uint64_t>(i) + 9970);
    LineMachine m;
    LineTarget t;
    t.steps = {static_cast<std::int32_t>(between(random, 4000, 40000)), 3000, -500};
    t.timed = true;
    const double seconds = between(random, 4, 8);
    t.time_us = static_cast<std::uint32_t>(seconds * 1e6);
    LineRig rig(m);
    rig.push(t);
    while (rig.seconds() < 0.5 * seconds) rig.step();
    const double before = rig.seconds();
    rig.miss(1 + random() % 8);
    while (rig.step() && rig.segments().back().settles) {
    }
    const LineSegment& first = rig.segments().back();
    ASSERT_FALSE(first.settles);
    // The time of the brake and of the move back is added.
    const double missed = static_cast<double>(first.segment.start_tick) * 1e-6 - before;
    rig.run();
    ASSERT_NO_FATAL_FAILURE(expect_at_end(rig));
    ASSERT_NEAR(rig.seconds(), seconds + missed, 0.002 * seconds + 0.01);
  }
}

/// A cancel comes to rest and discards the lines: by itself, and before or while segments are late.
TEST(LineReturn, ACancelMeanwhileStaysACancel) {
  for (int i = 0; i < scaled(40); ++i) {
    SCOPED_TRACE(testing::Message() << "path " << i);
    LineRandom random(static_cast<std::uint64_t>(i) + 9990);
    const LineMachine m = random_machine(random);
    LineRig rig(m);
    rig.check_ticks(20'000);
    for (int part = 0; part < 3; ++part) {
      for (const LineTarget& t : random_lines(random, m, 60, between(random, 0.05, 10)))
        rig.push(t);
      const std::uint64_t count = random() % 60;
      for (std::uint64_t k = 0; k < count; ++k) rig.step();
      const auto kind = random() % 3;
      if (kind != 0) rig.planner().cancel();
      if (kind == 1) {
        rig.miss(random() % 2 == 0 ? 1000 : random() % 9);
      } else if (kind == 0) {
        rig.miss(random() % 9, [&] { rig.planner().cancel(); });
      }
      rig.run();
      ASSERT_NO_FATAL_FAILURE(expect_cancelled(rig));
    }
    for (const LineTarget& t : random_lines(random, m, 10, 1)) rig.push(t);
    rig.run();
    ASSERT_NO_FATAL_FAILURE(expect_at_end(rig));
  }
}

}  // namespace
}  // namespace lamplock::test
