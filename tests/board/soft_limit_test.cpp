// Lines that would leave the work space: all of a curve or a cycle runs, or nothing of it.
#include <fmt/format.h>

#include <cmath>
#include <random>

#include "host/program/program_run.hpp"
#include "tests/board/program_host.hpp"

namespace lamplock::test::soft_limit_test {
namespace {

constexpr double steps_per_mm = 200;

class SoftLimit : public testing::Test {
 protected:
  double between(double low, double high) {
    return std::round(std::uniform_real_distribution<double>(low, high)(random_) * 1e3) / 1e3;
  }
  double low(int axis) const {
    return profile_.settings.milli(settings::Id::min_corner_x, axis) / 1e3;
  }
  double high(int axis) const {
    return low(axis) + profile_.settings.milli(settings::Id::travel_x, axis) / 1e3;
  }
  /// A place near a border.
  double near_border(int axis) {
    return random_() % 2 == 0 ? low(axis) + between(0, 4) : high(axis) - between(0, 4);
  }

  /// A line, and how far it goes out of the work space: below 0 it stays inside by that.
  struct Line {
    std::string text;
    double outside_mm;
  };
  double outside(int axis, double place) const {
    return std::max(low(axis) - place, place - high(axis));
  }
  /// Samples of x(t), y(t).
  template <class Curve>
  double outside(const Curve& curve) const {
    constexpr int samples = 4000;
    double most = -1e9;
    for (int i = 0; i <= samples; ++i) {
      const auto [x, y] = curve(static_cast<double>(i) / samples);
      most = std::max({most, outside(0, x), outside(1, y)});
    }
    return most;
  }

  Line circle(double x, double y) {
    const double i = between(-4, 4), j = between(-4, 4);
    const bool clockwise = random_() % 2 == 0;
    const double radius = std::hypot(i, j), from = std::atan2(-j, -i);
    const auto at = [&](double t) {
      const double angle = from + (clockwise ? -t : t) * 2 * M_PI;
      return std::pair{x + i + radius * std::cos(angle), y + j + radius * std::sin(angle)};
    };
    return {fmt::format("G90 G{} I{:.3f} J{:.3f} F6000", clockwise ? 2 : 3, i, j), outside(at)};
  }
  Line spline(double x, double y) {
    const double i = between(-9, 9), j = between(-9, 9), p = between(-9, 9), q = between(-9, 9);
    const double to_x = std::clamp(x + between(-3, 3), low(0), high(0));
    const double to_y = std::clamp(y + between(-3, 3), low(1), high(1));
    const auto at = [&](double t) {
      const double u = 1 - t;
      const auto cubic = [&](double a, double b, double c, double d) {
        return u * u * u * a + 3 * u * u * t * b + 3 * u * t * t * c + t * t * t * d;
      };
      return std::pair{cubic(x, x + i, to_x + p, to_x), cubic(y, y + j, to_y + q, to_y)};
    };
    return {fmt::format("G90 G5 I{:.3f} J{:.3f} P{:.3f} Q{:.3f} X{:.6f} Y{:.6f} F6000", i, j, p, q,
                        to_x, to_y),
            outside(at)};
  }
  Line cycle(double x, double z) {
    const double step = between(-2, 2), depth = between(0, 4), retract = between(0, 2);
    const int holes = 1 + static_cast<int>(random_() % 3);
    const double most = std::max({outside(0, x + step * holes), outside(0, x + step),
                                  outside(2, z - retract - depth), outside(2, z)});
    return {fmt::format("G91 G81 X{:.3f} R-{:.3f} Z-{:.3f} L{} F6000", step, retract, depth, holes),
            most};
  }

  job::Profile profile_ = program_profile();
  std::mt19937_64 random_{9};
};

TEST_F(SoftLimit, RunsAllOfACurveOrCycleOrNothing) {
  // Ends are rounded to steps of 0.005 mm.
  constexpr double rounding_mm = 0.006;
  int refused = 0, run = 0;
  for (int i = 0; i < scaled(120, 20); ++i) {
    Rig rig(profile_);
    ProgramHost host(rig);
    const double x = near_border(0), y = near_border(1), z = low(2) + between(1, 6);
    host.ask(fmt::format("G21 G90 G1 X{:.3f} Y{:.3f} Z{:.3f} F6000\n", x, y, z));
    ASSERT_TRUE(host.wait_for_rest(20));
    const StepPosition start = host.position();
    const Line line = i % 3 == 0 ? circle(x, y) : i % 3 == 1 ? spline(x, y) : cycle(x, z);
    if (std::abs(line.outside_mm) < rounding_mm) continue;
    const bool inside = line.outside_mm < 0;
    const auto plan = program_run::run_program(
        fmt::format("G21 G90 G1 X{:.3f} Y{:.3f} Z{:.3f} F6000\n{}\n", x, y, z, line.text),
        profile_.settings, 9);
    EXPECT_EQ(plan.problems.size(), inside ? 0u : 1u) << line.text;
    const auto answers = host.ask("M4 S1000 " + line.text + "\n");
    ASSERT_TRUE(inside || host.has_said("ALARM:2")) << line.text;
    ASSERT_EQ(answers.back() == "ok", inside)
        << x << " " << y << " " << z << " " << line.text << " " << line.outside_mm;
    rig.run(300 * ps_per_ms);
    ASSERT_TRUE(inside || host.position() == start) << line.text;
    (inside ? run : refused) += 1;
  }
  EXPECT_GT(std::min(run, refused), scaled(120, 20) / 5);
}

/// The machine does not start towards a place by way of which it would leave.
TEST_F(SoftLimit, ChecksBothEndsOfAWayHome) {
  Rig rig(profile_);
  ProgramHost host(rig);
  EXPECT_THAT(host.ask("G21 G90 G10 L2 P1 X0\nG1 X1 F600\n"), Each("ok"));
  ASSERT_TRUE(host.wait_for_rest(20));
  const StepPosition start = host.position();
  EXPECT_THAT(host.ask("G28 X999\n"), ElementsAre("ALARM:2", "error:33"));
  EXPECT_EQ(host.position(), start);
}

}  // namespace
}  // namespace lamplock::test::soft_limit_test
