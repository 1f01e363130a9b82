// The line planner during a run: overrides, hold, resume, cancel, a late host, timed moves.
#include <gtest/gtest.h>

#include "tests/motion/line_machine.hpp"
#include "tests/motion/line_paths.hpp"
#include "tests/motion/line_reference.hpp"
#include "tests/scale.hpp"

namespace lamplock::test {
namespace {

LineTarget along_x(const LineMachine& m, double mm, double mm_s) {
  LineTarget t;
  t.steps[0] = static_cast<std::int32_t>(std::lround(mm * m.steps_mm[0]));
  t.feed_um_min = static_cast<std::uint32_t>(std::lround(mm_s * 60e3));
  return t;
}

LineMachine machine_of(double accel_mm_s2) {
  LineMachine m;
  m.accel_mm_s2.fill(accel_mm_s2);
  return m;
}

/// Smallest acceleration along any direction.
double min_accel(const LineMachine& m) {
  double least = 1e300;
  for (int a = 0; a < m.axes; ++a) least = std::min(least, m.accel_mm_s2[index(a)]);
  return least;
}

/// Without and with limits of jerk.
class Overrides : public testing::TestWithParam<bool> {};

TEST_P(Overrides, AndHoldsAtRandomTimesKeepLimitsAndEndExactly) {
  const bool jerk = GetParam();
  for (int i = 0; i < scaled(12); ++i) {
    SCOPED_TRACE(testing::Message() << "path " << i);
    LineRandom random(static_cast<std::uint64_t>(i) + (jerk ? 9800 : 9200));
    LineMachine m = random_machine(random);
    if (jerk) limit_jerk(random, m);
    const std::size_t most = jerk ? 100 : 300;
    const auto targets = random_lines(random, m, 20 + random() % most, between(random, 0.02, 10));
    LineRig rig(m);
    rig.check_ticks(jerk ? 50'000 : 20'000);
    std::size_t pushed = 0;
    const std::uint64_t every = 1 + random() % 60;
    for (bool going = true; going;) {
      while (pushed < targets.size() && rig.push(targets[pushed])) ++pushed;
      if (random() % every == 0)
        rig.planner().set_feed_percent(static_cast<std::uint32_t>(between(random, 5, 250)));
      if (random() % every == 0)
        rig.planner().set_rapid_percent(static_cast<std::uint32_t>(25u << random() % 3));
      if (random() % (4 * every) == 0) {
        rig.planner().hold();
        const double t = rig.seconds();
        const std::size_t before = rig.segments().size();
        rig.run();
        ASSERT_FALSE(testing::Test::HasFatalFailure());
        ASSERT_TRUE(rig.planner().at_rest());
        ASSERT_TRUE(rig.at().at_rest());
        const double ticks = 3e-6 * static_cast<double>(rig.segments().size() - before);
        if (!jerk && rig.segments().size() != before) {
          // Start of the brake: rounding to whole ticks makes a small corner of every junction.
          const double v = rig.start_mm_s(rig.segments()[before]);
          ASSERT_LE(rig.seconds() - t, v / min_accel(m) * 1.004 + ticks);
        }
        rig.planner().resume();
      }
      going = rig.step() || pushed < targets.size();
      ASSERT_FALSE(testing::Test::HasFatalFailure());
    }
    ASSERT_TRUE(rig.planner().idle());
    ASSERT_NO_FATAL_FAILURE(expect_at_end(rig));
  }
}

INSTANTIATE_TEST_SUITE_P(Jerk, Overrides, testing::Bool());

TEST(LineStream, AnOverrideActsOnTheNextSegment) {
  const LineMachine m = machine_of(1000);
  LineRig rig(m);
  rig.push(along_x(m, 300, 100));
  while (rig.seconds() < 0.5) rig.step();
  EXPECT_NEAR(rig.speed_mm_s(rig.segments().back()), 100, 0.01);
  rig.planner().set_feed_percent(50);
  rig.step();
  EXPECT_NEAR(rig.speed_mm_s(rig.segments().back()), 100 - 8, 0.2);
  for (int i = 0; i < 8; ++i) rig.step();
  EXPECT_NEAR(rig.speed_mm_s(rig.segments().back()), 50, 0.01);
  rig.planner().set_feed_percent(1000);  // 200
  rig.step();
  EXPECT_NEAR(rig.speed_mm_s(rig.segments().back()), 50 + 8, 0.2);
  for (int i = 0; i < 20; ++i) rig.step();
  EXPECT_NEAR(rig.speed_mm_s(rig.segments().back()), 200, 0.02);
  rig.planner().hold();
  const double t = rig.seconds();
  rig.run();
  EXPECT_NEAR(rig.seconds() - t, 0.2, 0.001);
  EXPECT_LT(rig.at().axis[0].step(), rig.targets().back().steps[0]);
  EXPECT_FALSE(rig.planner().idle());
  rig.planner().resume();
  rig.run();
  expect_at_end(rig);
}

TEST(LineStream, RapidsFollowTheirOwnOverride) {
  const LineMachine m = machine_of(10000);
  for (const std::uint32_t percent : {25u, 50u, 100u}) {
    LineRig rig(m);
    rig.planner().set_feed_percent(10);
    rig.planner().set_rapid_percent(percent);
    LineTarget t = along_x(m, 400, 1);
    t.rapid = true;
    rig.push(t);
    rig.run();
    const double v = 10.0 * percent;
    EXPECT_NEAR(rig.seconds(), 400 / v + v / 10000, 0.001 * 400 / v);
  }
}

TEST(LineStream, ALateHostCostsOnlyTime) {
  for (int i = 0; i < scaled(12); ++i) {
    SCOPED_TRACE(testing::Message() << "path " << i);
    LineRandom random(static_cast<std::uint64_t>(i) + 9400);
    const LineMachine m = random_machine(random);
    const auto targets = random_lines(random, m, 100, between(random, 0.02, 10));
    LineRig rig(m);
    rig.check_ticks(20'000);
    for (std::size_t next = 0; next < targets.size() || !rig.planner().idle();) {
      const auto lines = random() % 4 == 0 ? random() % 12 : 0;
      for (std::size_t k = 0; k < lines && next < targets.size(); ++k)
        if (rig.push(targets[next])) ++next;
      const auto segments = random() % 8;
      for (std::size_t k = 0; k < segments; ++k) rig.step();
      ASSERT_FALSE(testing::Test::HasFatalFailure());
    }
    ASSERT_NO_FATAL_FAILURE(expect_at_end(rig));
    // Limits from chords may be known too late.
    ASSERT_GE(rig.seconds(), LineReference(m, targets, false).seconds() * (1 - 1e-5));
  }
}

TEST(LineStream, StraightPathsOfRoundedPointsDoNotStutter) {
  for (int i = 0; i < scaled(12); ++i) {
    LineRandom random(static_cast<std::uint64_t>(i) + 9500);
    LineMachine m = machine_of(1000);
    const double angle = std::uniform_real_distribution<double>(0, 6.283)(random);
    const double tilt = std::uniform_real_distribution<double>(-1, 1)(random);
    const double pitch = between(random, 0.01, 0.3), v = 60;
    std::vector<LineTarget> targets;
    for (int k = 1; k * pitch < 50; ++k) {
      const double s = k * pitch;
      LineTarget t;
      const LineVector mm{s * std::cos(angle), s * std::sin(angle), s * tilt, 0};
      for (std::size_t a = 0; a < 3; ++a)
        t.steps[a] = static_cast<std::int32_t>(std::lround(mm[a] * m.steps_mm[a]));
      t.feed_um_min = 60'000 * static_cast<std::uint32_t>(v);
      targets.push_back(t);
    }
    LineRig rig(m);
    rig.stream(targets);
    ASSERT_FALSE(testing::Test::HasFatalFailure());
    // Braking needs 1.8 mm: the minimum length of lines in the ring.
    if (pitch * motion::LineRing::capacity < 2) continue;
    for (const LineSegment& s : rig.segments()) {
      const double t = static_cast<double>(s.segment.end.tick) * 1e-6;
      if (t > 0.08 && t < rig.seconds() - 0.08) {
        ASSERT_GT(rig.speed_mm_s(s), 0.97 * v) << "path " << i << " pitch " << pitch;
      }
    }
  }
}

TEST(LineStream, AReversalAndAnExactStopAreFullStops) {
  const LineMachine m = machine_of(1000);
  LineRig rig(m);
  for (const double mm : {10.0, 20.0, 15.0, 20.0, 30.0}) rig.push(along_x(m, mm, 50));
  LineTarget exact = along_x(m, 40, 50);
  exact.exact_stop = true;
  rig.push(exact);
  rig.push(along_x(m, 50, 50));
  rig.run();
  ASSERT_FALSE(testing::Test::HasFatalFailure());
  for (const LineSegment& s : rig.segments())
    if (s.ends_line) {
      const bool stops = s.line == 1 || s.line == 2 || s.line >= 5;
      EXPECT_EQ(s.segment.end.at_rest(), stops) << s.line;
      if (!stops) {
        EXPECT_NEAR(rig.speed_mm_s(s), 50, 0.1);
      }
    }
}

TEST(LineStream, TimedMovesTakeTheirTime) {
  for (int i = 0; i < scaled(80); ++i) {
    SCOPED_TRACE(testing::Message() << "line " << i);
    const bool jerk = i % 4 == 3;
    LineRandom random(static_cast<std::uint64_t>(i) + 9600);
    LineMachine m = random_machine(random);
    if (jerk) limit_jerk(random, m);
    auto targets = random_lines(random, m, 1, between(random, 0.5, 20));
    targets[0].rapid = true;
    LineRig fastest(m);
    fastest.stream(targets);
    const double wanted = fastest.seconds() * between(random, jerk ? 1.1 : 1.05, 50);
    targets[0].rapid = false;
    targets[0].timed = true;
    targets[0].time_us = static_cast<std::uint32_t>(wanted * 1e6);
    LineRig rig(m);
    rig.stream(targets);
    ASSERT_NO_FATAL_FAILURE(expect_at_end(rig));
    // Pulses of whole stairs take some ticks more than planned.
    EXPECT_NEAR(rig.seconds(), wanted, jerk ? 0.002 * wanted + 0.003 : 0.001 * wanted + 4e-6);
  }
}

TEST(LineStream, PowerIsConstantOrInProportionToSpeed) {
  const LineMachine m = machine_of(1000);
  for (const motion::LinePower laser :
       {motion::LinePower::off, motion::LinePower::constant, motion::LinePower::proportional}) {
    LineRig rig(m);
    LineTarget t = along_x(m, 100, 80);
    t.power = 40000;
    t.laser = laser;
    rig.push(t);
    t = along_x(m, 0, 80);
    t.power = 40000;
    t.laser = laser;
    t.rapid = true;
    rig.push(t);
    rig.planner().set_feed_percent(150);
    rig.run();
    for (const LineSegment& s : rig.segments()) {
      const auto expected = [&](double mm_s) {
        if (laser == motion::LinePower::off || s.rapid) return 0.0;
        if (laser == motion::LinePower::constant) return 40000.0;
        return std::min(65535.0, 40000 * mm_s / 80);
      };
      EXPECT_NEAR(s.power_start, expected(rig.start_mm_s(s)), 2);
      EXPECT_NEAR(s.power_cruise, expected(rig.cruise_mm_s(s)), 2);
      EXPECT_NEAR(s.power_end, expected(rig.speed_mm_s(s)), 2);
    }
  }
}

}  // namespace
}  // namespace lamplock::test
