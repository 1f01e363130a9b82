// Curves and rotation: the interpreter's moves for arcs, splines and G68.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tests/program/rig.hpp"
#include "tests/scale.hpp"

namespace lamplock::program::interpreter_curves_test {
namespace {

using lamplock::test::scaled;
using test::at;
using test::expect_rows;
using test::mm;
using test::Rig;

std::vector<Action> actions_of(Rig& rig, const std::string& line) {
  const Fault fault = rig.interpreter.run(line);
  EXPECT_FALSE(fault) << line << ": " << test::text_of(fault);
  return rig.take();
}

double x_of(const Action& action) { return static_cast<double>(action.target_e7[0]) / 1e7; }
double y_of(const Action& action) { return static_cast<double>(action.target_e7[1]) / 1e7; }

/// Every piece ends on a circle, the last one at the programmed end, and the path turns by `turn`
/// radians, positive anticlockwise.
void expect_arc(const std::string& line, Place end, double cx, double cy, double radius,
                double turn) {
  Rig rig;
  rig.run_all("F60|X10 Y0");
  const std::vector<Action> actions = actions_of(rig, line);
  ASSERT_GE(actions.size(), 4u) << line;
  EXPECT_EQ(actions.back().target_e7, end) << line;
  EXPECT_EQ(rig.machine(), end) << line;
  double angle = std::atan2(0 - cy, 10 - cx), turned = 0;
  for (const Action& action : actions) {
    EXPECT_EQ(action.programmed_end, &action == &actions.back());
    EXPECT_EQ(action.feed_um_min, 60'000u);
    EXPECT_NEAR(std::hypot(x_of(action) - cx, y_of(action) - cy), radius, 1e-5) << line;
    const double next = std::atan2(y_of(action) - cy, x_of(action) - cx);
    turned += std::remainder(next - angle, 2 * M_PI);
    angle = next;
  }
  EXPECT_NEAR(turned, turn, 1e-5) << line;
}

TEST(Curves, Arcs) {
  const double half = M_PI;
  expect_arc("G2 X-10 I-10", at(-10, 0), 0, 0, 10, -half);
  expect_arc("G3 X-10 I-10", at(-10, 0), 0, 0, 10, half);
  expect_arc("G3 X10 I-10", at(10, 0), 0, 0, 10, 2 * half);
  expect_arc("G2 X10 I-10", at(10, 0), 0, 0, 10, -2 * half);
  expect_arc("G3 X0 Y10 I-10 J0", at(0, 10), 0, 0, 10, half / 2);
  expect_arc("G2 X0 Y10 I-10 J0", at(0, 10), 0, 0, 10, -1.5 * half);
  expect_arc("G3 X0 Y10 R10", at(0, 10), 0, 0, 10, half / 2);
  expect_arc("G3 X0 Y10 R-10", at(0, 10), 10, 10, 10, 1.5 * half);
  expect_arc("G2 X0 Y10 R10", at(0, 10), 10, 10, 10, -half / 2);
  expect_arc("G3 X0 Y10 Z5 I-10", at(0, 10, 5), 0, 0, 10, half / 2);
  expect_arc("G3 X0 Y10 I-10 P3", at(0, 10), 0, 0, 10, 4.5 * half);
  expect_arc("G90.1 G3 X0 Y10 I0 J0", at(0, 10), 0, 0, 10, half / 2);
  expect_arc("G91 G3 X-10 Y10 I-10", at(0, 10), 0, 0, 10, half / 2);
  expect_arc("G91 G90.1 G3 X-10 Y10 I0 J0", at(0, 10), 0, 0, 10, half / 2);
  expect_arc("G3 X0 Y10 I-10 K3", at(0, 10), 0, 0, 10, half / 2);
}

TEST(Curves, ArcsWithOffsetsAndUnits) {
  Rig rig;
  rig.run("G20 G10 L2 P1 X1 Y1");
  rig.run("F60 G0 X1 Y0");
  const std::vector<Action> actions = actions_of(rig, "G90.1 G3 X0 Y1 I0 J0");
  EXPECT_EQ(actions.back().target_e7, at(25.4, 50.8));
  for (const Action& action : actions)
    EXPECT_NEAR(std::hypot(x_of(action) - 25.4, y_of(action) - 25.4), 25.4, 1e-5);
}

TEST(Curves, ArcsInOtherPlanes) {
  Rig rig;
  rig.run_all("F60|G18 Z10");
  for (const Action& action : actions_of(rig, "G3 Z0 X10 K-10"))  // from Z towards X
    EXPECT_GE(action.target_e7[0], 0);
  EXPECT_EQ(rig.machine(), at(10, 0, 0));
  rig.run("G19 G0 X0 Y10");
  for (const Action& action : actions_of(rig, "G3 Y0 Z10 J-10")) EXPECT_GE(action.target_e7[2], 0);
  EXPECT_EQ(rig.machine(), at(0, 0, 10));
}

TEST(Curves, SplinesAreTheirBezierCurves) {
  Rig rig;
  rig.run("F60");
  const std::vector<Action> first = actions_of(rig, "G5 X10 Y0 I0 J10 P0 Q10");
  EXPECT_EQ(first.back().target_e7, at(10, 0));
  double highest = 0;
  for (const Action& action : first) highest = std::max(highest, y_of(action));
  EXPECT_NEAR(highest, 7.5, 0.01);  // 3/4 of the height of its control points
  // Continues in the same direction: down below the axis.
  const std::vector<Action> second = actions_of(rig, "X20 Y0 P0 Q-10");
  double lowest = 0;
  for (const Action& action : second) lowest = std::min(lowest, y_of(action));
  EXPECT_NEAR(lowest, -7.5, 0.01);
  // Not after a move of another kind.
  rig.run("G0 X0 Y0");
  EXPECT_EQ(rig.run("G5 X10 P0 Q10"), "35@1");
  // A parabola, which reaches half the height of its control point.
  highest = 0;
  for (const Action& action : actions_of(rig, "G5.1 X10 Y0 I5 J10"))
    highest = std::max(highest, y_of(action));
  EXPECT_NEAR(highest, 5, 0.01);
}

TEST(Curves, InverseTimeIsDividedByLength) {
  const std::pair<const char*, double> lines[] = {{"G3 X-10 I-10 F2", 30e6},
                                                  {"G5 X40 I50 J50 P1 Q3 F4", 15e6},
                                                  {"G3 X10 Z50 I-10 F0.5", 120e6}};
  for (const auto& [line, wanted] : lines) {
    Rig rig;
    rig.run("X10");
    const std::vector<Action> actions = actions_of(rig, std::string("G93") + line);
    double length = 0, time = 0;
    Place from = at(10, 0);
    std::vector<double> lengths;
    for (const Action& action : actions) {
      lengths.push_back(static_cast<double>(distance_e7(from, action.target_e7)));
      length += lengths.back();
      from = action.target_e7;
      EXPECT_TRUE(action.timed);
      time += action.time_us;
    }
    EXPECT_EQ(time, wanted) << line;
    for (std::size_t i = 0; i + 1 < actions.size(); ++i)
      EXPECT_NEAR(actions[i].time_us, time * lengths[i] / length, time * 1e-3 / 2 + 2) << line;
  }
}

TEST(CurveTiming, DistancesAreRight) {
  std::mt19937_64 random(7);
  for (int i = 0; i < scaled(2000); ++i) {
    Place a{}, b{};
    long double sum = 0;
    const auto shift = random() % 30;
    for (std::size_t k = 0; k < 4; ++k) {
      a[k] = static_cast<std::int64_t>(random() % 200'000'000'000 >> shift);
      b[k] = static_cast<std::int64_t>(random() % 200'000'000'000 >> shift);
      sum += static_cast<long double>(a[k] - b[k]) * static_cast<long double>(a[k] - b[k]);
    }
    const long double wanted = std::sqrt(sum);
    EXPECT_NEAR(static_cast<double>(distance_e7(a, b)), static_cast<double>(wanted),
                static_cast<double>(1 + wanted * 2e-8L));
  }
}

TEST(Rotation, ByRightAnglesIsExact) {
  expect_rows({
      {"G68 X0 Y0 R90|X1.2345678 Y2", "rapid to -2 1.2345678 0"},
      {"G68 X0 Y0 R180|X1 Y2 Z3", "rapid to -1 -2 3"},
      {"G68 X0 Y0 R270|X1 Y2", "rapid to 2 -1 0"},
      {"G68 X0 Y0 R-90|X1 Y2", "rapid to 2 -1 0"},
      {"G68 X0 Y0 R360|X1 Y2", "rapid to 1 2 0"},
      {"G68 X0 Y0 R360000090|X1 Y2", "rapid to -2 1 0"},
      {"G68 X5 Y0 R90|X6 Y0", "rapid to 5 1 0"},
      {"X5 Y5|G68 R90|X6 Y5", "rapid to 5 6 0"},
      {"X5 Y5|G68 R90|G91 X1", "rapid to 5 6 0"},
      {"X5 Y5|G91 G68 X1 Y1 R90|G90 X7 Y6", "rapid to 6 7 0"},
      {"G10 L2 P1 X5 Y5|G68 X0 Y0 R90|X1 Y0", "rapid to 5 6 0"},
      {"G20 G68 X1 Y0 R90|X2 Y0", "rapid to 25.4 25.4 0"},
      {"G18 G68 X0 Z0 R90|X1 Z2 Y3", "rapid to 2 3 -1"},  // from Z towards X
      {"G19 G68 Y0 Z0 R90|X1 Y2 Z3", "rapid to 1 -3 2"},
      {"G68 X0 Y0 R90|G18|X1", "rapid to 0 1 0"},
      {"G68 X0 Y0 R90|X1|G69 X1", "rapid to 1 1 0"},
      {"G68 X0 Y0 R90|X1|G69|Y5", "rapid to 0 5 0"},
      {"X3|G68 X0 Y0 R90|X1", "rapid to 3 1 0"},  // from the machine's position
      {"G68 X0 Y0 R90|G68 X0 Y0 R180|X1 Y0", "rapid to -1 0 0"},
      {"G68 X0 Y0 R90|G53 X1", "rapid to 1 0 0"},
      {"G68 X0 Y0 R90|G53 X1|Y5", "rapid to -5 0 0"},
      {"X1|G28.1|G68 X0 Y0 R90|X5|G28", "rapid to 1 0 0"},
      {"X1|G28.1|G68 X0 Y0 R90|G28 X5", "rapid to 1 5 0 on the way; rapid to 1 5 0"},
      {"G68 X0 Y0 R90|M2|G0 X1", "rapid to 1 0 0"},
  });
}

TEST(Rotation, ArcsTurnWithIt) {
  Rig rig;
  rig.run_all("F60|X10|G68 X0 Y0 R90|X10 Y0");
  const std::vector<Action> actions = actions_of(rig, "G3 X0 Y10 I-10");
  EXPECT_EQ(actions.back().target_e7, at(-10, 0));
  for (const Action& action : actions) {
    EXPECT_NEAR(std::hypot(x_of(action), y_of(action)), 10, 1e-5);
    EXPECT_GE(y_of(action), 0);
  }
}

/// Compared with long double, 4 m from the centre; and rotated back.
TEST(Rotation, ByAnyAngle) {
  std::mt19937_64 random(8);
  for (int i = 0; i < scaled(5000); ++i) {
    const std::int64_t angle_e7 =
        static_cast<std::int64_t>(random() % 14'400'000'001) - 7'200'000'000;
    const auto coordinate = [&random] {
      return static_cast<std::int64_t>(random() % 60'000'000'001) - 30'000'000'000;
    };
    const Place centre{coordinate() / 100, coordinate() / 100, 0, 0};
    const Place place{coordinate(), coordinate(), coordinate(), 7};
    const Rotation rotation(0, 1, centre, angle_e7);
    const Place turned = rotation.turned(place);
    const long double angle = static_cast<long double>(angle_e7) / 1e7L * std::acos(-1.0L) / 180;
    const auto x = static_cast<long double>(place[0] - centre[0]);
    const auto y = static_cast<long double>(place[1] - centre[1]);
    const long double wanted_x = x * std::cos(angle) - y * std::sin(angle);
    const long double wanted_y = x * std::sin(angle) + y * std::cos(angle);
    EXPECT_NEAR(static_cast<double>(static_cast<long double>(turned[0] - centre[0]) - wanted_x), 0,
                0.6);
    EXPECT_NEAR(static_cast<double>(static_cast<long double>(turned[1] - centre[1]) - wanted_y), 0,
                0.6);
    EXPECT_EQ(turned[2], place[2]);
    EXPECT_EQ(turned[3], place[3]);
    const Place back = rotation.turned_back(turned);
    EXPECT_LE(std::abs(back[0] - place[0]), 1);
    EXPECT_LE(std::abs(back[1] - place[1]), 1);
  }
}

/// A relative program under a rotation ends at the same point as the absolute one.
TEST(Rotation, DoesNotDrift) {
  Rig relative, absolute;
  relative.run("G91 G68 X0 Y0 R33.3");
  absolute.run("G68 X0 Y0 R33.3");
  for (int i = 1; i <= 1000; ++i) {
    relative.run("X0.1 Y0.01");
    absolute.run(fmt::format("X{}Y{}", test::decimal(i * 1'000'000), test::decimal(i * 100'000)));
    ASSERT_EQ(relative.machine(), absolute.machine());
  }
}

}  // namespace
}  // namespace lamplock::program::interpreter_curves_test
