// The line planner: properties of every path, and the duration of paths.
#include "firmware/motion/line/planner.hpp"

#include <gtest/gtest.h>

#include "tests/motion/line_machine.hpp"
#include "tests/motion/line_paths.hpp"
#include "tests/motion/line_reference.hpp"
#include "tests/scale.hpp"

namespace lamplock::test {
namespace {

std::uint32_t feed(double mm_s) { return static_cast<std::uint32_t>(std::lround(mm_s * 60e3)); }

LineTarget to_mm(const LineMachine& m, LineVector mm, double mm_s) {
  LineTarget t;
  for (int a = 0; a < m.axes; ++a) put_place(t, a, mm[index(a)] * m.steps_mm[index(a)]);
  t.feed_um_min = feed(mm_s);
  return t;
}

TEST(LinePlanner, ALineFromRestToRest) {
  LineMachine m;
  m.accel_mm_s2.fill(1000);
  LineRig rig(m);
  rig.check_ticks(1'000'000);
  rig.push(to_mm(m, {30, 40, 0}, 100));
  rig.run();
  ASSERT_FALSE(testing::Test::HasFatalFailure());
  EXPECT_TRUE(rig.at().at_rest());
  EXPECT_TRUE(rig.planner().idle());
  // 1.25 m/s2 along the line (0.8 of it is an axis' limit): l/v + v/a.
  EXPECT_NEAR(rig.seconds(), 0.5 + 0.1 / 1.25, 0.0005);
}

TEST(LinePlanner, ASharpCornerIsPassedAtTheSpeedJumpOfTheAxesThatTurn) {
  // X keeps its speed and Z is at rest: their zero speed jump does not matter. Y changes by 1.6
  // times the speed.
  LineMachine m;
  m.jump_mm_s = {0, 8, 0};
  m.deviation_mm = 0.001;
  LineRig rig(m);
  rig.push(to_mm(m, {6, 8, 0}, 100));
  rig.push(to_mm(m, {12, 0, 0}, 100));
  rig.run();
  ASSERT_FALSE(testing::Test::HasFatalFailure());
  double corner = 0;
  for (const LineSegment& s : rig.segments())
    if (s.ends_line && s.line == 0) corner = rig.speed_mm_s(s);
  EXPECT_NEAR(corner, 8 / 1.6, 0.01);
  // A third axis that also changes and may not jump prevents the jump.
  LineRig other(m);
  other.push(to_mm(m, {6, 8, 0}, 100));
  other.push(to_mm(m, {12, 0, 0.1}, 100));
  other.run();
  for (const LineSegment& s : other.segments()) {
    if (s.ends_line && s.line == 0) {
      EXPECT_LT(other.speed_mm_s(s), 2.5);
    }
  }
}

/// Points on a curve of 0.1 mm lines.
std::vector<LineTarget> curve(const LineMachine& m, double radius_mm, double length_mm,
                              double mm_s) {
  std::vector<LineTarget> targets;
  for (int i = 1; i < std::lround(10 * length_mm); ++i) {
    const double angle = 0.1 * i / radius_mm;
    targets.push_back(
        to_mm(m, {radius_mm * std::sin(angle), radius_mm * (1 - std::cos(angle)), 0}, mm_s));
  }
  return targets;
}

TEST(LinePlanner, GentlyCurvedPathOfDensePointsKeepsItsSpeed) {
  LineMachine m;
  m.accel_mm_s2.fill(1000);
  LineRig rig(m);
  rig.check_ticks(1'000'000);
  const double length = 200, v = 100;
  rig.stream(curve(m, 50, length, v));
  ASSERT_FALSE(testing::Test::HasFatalFailure());
  EXPECT_TRUE(rig.at().at_rest());
  EXPECT_NEAR(rig.seconds(), length / v + v / 1000, 0.01 * length / v);
  double slowest = 1e9;
  for (const LineSegment& s : rig.segments()) {
    const double t = static_cast<double>(s.segment.end.tick) * 1e-6;
    if (t > 0.15 && t < rig.seconds() - 0.15) slowest = std::min(slowest, rig.speed_mm_s(s));
  }
  EXPECT_GT(slowest, 0.98 * v);
}

/// Largest acceleration of an axis on a circle that begins at 0 along x, relative to its limit,
/// before the last chord, which is incomplete at the end of the path and limits nothing.
double worst_axis_accel(const LineRig& rig, double radius_mm) {
  const LineMachine& m = rig.machine();
  const double step_mm = 1 / m.steps_mm[0],
               last_mm = 128 * std::min(step_mm, step_mm / 16 + 0.0254);
  double worst = 0;
  for (const LineSegment& s : rig.segments()) {
    if (s.line + last_mm / 0.1 + 1 > static_cast<double>(rig.targets().size())) break;
    const double x = steps_off_middle(s.segment.end.axis[0].position_q64, 0) / m.steps_mm[0];
    const double y =
        radius_mm - steps_off_middle(s.segment.end.axis[1].position_q64, 0) / m.steps_mm[1];
    const double along = std::max(std::fabs(x), std::fabs(y)) / std::hypot(x, y);
    const double v = rig.speed_mm_s(s);
    worst = std::max(worst, v * v / radius_mm * along / m.accel_mm_s2[0]);
  }
  return worst;
}

/// Time along a circle if only the acceleration of an axis limits the speed.
double circle_seconds(double radius_mm, double length_mm, double accel_mm_s2, double mm_s) {
  double seconds = 0;
  const int parts = 1000;
  for (int i = 0; i < parts; ++i) {
    const double angle = length_mm / radius_mm * i / parts;
    const double along = std::max(std::fabs(std::sin(angle)), std::fabs(std::cos(angle)));
    seconds += length_mm / parts / std::min(mm_s, std::sqrt(accel_mm_s2 * radius_mm / along));
  }
  return seconds;
}

TEST(LinePlanner, TightCurvesOfDensePointsAreSlowedAsTheirRadiusRequires) {
  for (const double steps_mm : {80.0, 200.0, 800.0})
    for (const double radius : {1.0, 2.0, 4.0, 10.0}) {
      SCOPED_TRACE(testing::Message() << steps_mm << " steps/mm, radius " << radius);
      LineMachine m;
      m.steps_mm.fill(steps_mm);
      m.accel_mm_s2.fill(1000);
      LineRig rig(m);
      rig.stream(curve(m, radius, 80, 200));
      // A chord of 128 coarse steps is a quarter of the smallest circle.
      EXPECT_LT(worst_axis_accel(rig, radius), steps_mm < 100 ? 1.25 : 1.15);
      EXPECT_LT(rig.seconds(), (radius * steps_mm < 150 ? 1.25 : 1.15) *
                                   (circle_seconds(radius, 80, 1000, 200) + 0.1));
    }
}

TEST(LinePlanner, CoarseMachinesDetectTheCurvature) {
  // A step is 0.15 mm, longer than the lines. Rounding is 0.035 mm: the smallest circle is as many
  // roundings wide as the one above.
  LineMachine m;
  m.steps_mm.fill(512 / 78.0);
  m.accel_mm_s2.fill(1000);
  for (const double radius : {4.0, 10.0, 50.0}) {
    SCOPED_TRACE(testing::Message() << "radius " << radius);
    LineRig rig(m);
    // The ring has room for lines of this length.
    constexpr double length = 200, mm_s = 120;
    rig.stream(curve(m, radius, length, mm_s));
    const double best = circle_seconds(radius, length, 1000, mm_s) + mm_s / 1000;
    EXPECT_LT(worst_axis_accel(rig, radius), 1.15);
    EXPECT_LT(rig.seconds(), 1.15 * best);
  }
}

TEST(LinePlanner, RandomPathsKeepLimitsAndTakeNearMinimumTime) {
  double worst = 0;
  for (int i = 0; i < scaled(40); ++i) {
    SCOPED_TRACE(testing::Message() << "path " << i);
    LineRandom random(static_cast<std::uint64_t>(i) + 9000);
    const LineMachine m = random_machine(random);
    const std::size_t count = 1 + random() % motion::LineRing::capacity;
    const std::vector<LineTarget> targets =
        random_lines(random, m, count, between(random, 0.02, 20));
    LineRig rig(m);
    rig.check_ticks(20'000);
    for (const LineTarget& t : targets) ASSERT_TRUE(rig.push(t));
    rig.run();
    ASSERT_FALSE(testing::Test::HasFatalFailure());
    ASSERT_TRUE(rig.at().at_rest());
    ASSERT_TRUE(rig.planner().idle());
    for (int a = 0; a < m.axes; ++a)
      ASSERT_EQ(rig.at().axis[index(a)].step(), targets.back().steps[index(a)]);
    const LineReference best(m, targets);
    const double slack = 1e-6 * static_cast<double>(best.lines());
    ASSERT_GE(rig.seconds(), best.seconds() * (1 - 1e-5) - 1e-6);
    EXPECT_LE(rig.seconds(), best.seconds() * 1.005 + slack);
    for (const LineSegment& s : rig.segments()) {
      if (!s.ends_line) continue;
      // Next to a reversal, directions are not known accurately enough for a tighter bound.
      ASSERT_LE(rig.speed_mm_s(s), best.end_mm_s(s.line) * (1 + 1e-4) + 0.05 * rig.tick_of_accel());
    }
    worst = std::max(worst, (rig.seconds() - slack) / best.seconds() - 1);
  }
  std::cout << "slower than the reference and a tick per line: " << worst << "\n";
}

}  // namespace
}  // namespace lamplock::test
