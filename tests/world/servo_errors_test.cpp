// Errors of servo drives: hand-made tables of runs, and the two trajectories of the paper on the
// virtual board.
#include "host/program/servo_errors.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <random>

#include "host/error.hpp"
#include "host/program/servo_picture.hpp"
#include "tests/scale.hpp"

namespace lamplock::program_run::servo_errors_test {
namespace {

using testing::HasSubstr;

constexpr double pulse_mm = 78.0 / 512, count_mm = 78.0 / 2048;
const char* const line_program = "G21 G90 G94 G1 X100 Y150 F600\n";

TEST(ServoErrors, AreTheExtremesOfBothSigns) {
  ServoRun run;
  run.moving_s = 0.003;
  run.pulses = {4, -3};
  run.steps_per_mm = 2;
  run.samples = {{0, {{{0, 0, 0}, {0, 0, 0}}}},
                 {0.001, {{{0.5, 0.4, 0.25}, {-0.5, -0.75, -0.625}}}},
                 {0.002, {{{0.5, 0.6, 0.625}, {-0.5, -0.5, -0.5}}}}};
  const ServoErrors errors = servo_errors(run, 2, "by hand");
  EXPECT_EQ(errors.samples, 3u);
  EXPECT_DOUBLE_EQ(errors.axis[0].max_mm, 0.25);
  EXPECT_DOUBLE_EQ(errors.axis[0].min_mm, -0.125);
  EXPECT_DOUBLE_EQ(errors.axis[0].rms_mm, std::sqrt((0.0625 + 0.015625) / 3));
  EXPECT_DOUBLE_EQ(errors.axis[1].max_mm, 0.125);
  EXPECT_DOUBLE_EQ(errors.axis[1].min_mm, 0);
  EXPECT_NEAR(errors.axis[0].max_pulses, 0.2, 1e-12);
  EXPECT_NEAR(errors.axis[1].max_pulses, 0.5, 1e-12);
  EXPECT_DOUBLE_EQ(errors.axis[0].measured_end_mm, 0.625);
  EXPECT_EQ(errors.axis[1].end_pulses, -3);
  EXPECT_THAT(servo_table({errors}), HasSubstr("by hand     X        0.2500    -0.1250"));
}

TEST(ServoErrors, LagAlongThePathIsNotDeviation) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int i = 0; i < test::scaled(50); ++i) {
    const double vx = 20 * any(random), vy = 20 * any(random), beside = 0.1 * any(random);
    const double speed = std::hypot(vx, vy), late_s = 0.02;
    ServoRun run;
    run.steps_per_mm = 1;
    for (int n = 0; n <= 500; ++n) {
      ServoSample sample{n * 0.001, {}};
      const double t = sample.at_s, late = std::max(0.0, t - late_s);
      sample.axis[0] = {vx * t, vx * t, vx * late - beside * vy / speed};
      sample.axis[1] = {vy * t, vy * t, vy * late + beside * vx / speed};
      run.samples.push_back(sample);
    }
    const ServoErrors errors = servo_errors(run, 1, "late");
    EXPECT_NEAR(errors.beside_mm, std::abs(beside), 1e-9);
    EXPECT_GE(errors.axis[0].max_mm - errors.axis[0].min_mm,
              std::abs(vx) * late_s - std::abs(beside));
  }
}

TEST(ServoRun, PulsesStayWithinHalfAPulseAndEndAtTheNearest) {
  const ServoMachine machine;
  const auto centre = centre_of({0, 0}, {100, 120}, 150);
  EXPECT_NEAR(std::hypot(centre[0], centre[1]), 150, 1e-9);
  EXPECT_NEAR(std::hypot(100 - centre[0], 120 - centre[1]), 150, 1e-9);
  EXPECT_STREQ(arc_code({0, 0}, {100, 120}, centre), "G2");
  EXPECT_STREQ(arc_code({100, 120}, {0, 0}, centre), "G3");
  EXPECT_THROW(centre_of({0, 0}, {100, 120}, 78), Error);
  const struct {
    std::string text;
    std::array<long, 2> end;
  } rows[] = {{line_program, {656, 985}},
              {"G21 G90 G94 G2 X100 Y120 R150 F600\n", {656, 788}},
              {"G21 G90 G94 G3 X100 Y120 R150 F600\n", {656, 788}}};
  for (const auto& row : rows) {
    const ServoRun run = run_on_servos(row.text, machine, "test");
    EXPECT_EQ(run.pulses, row.end);
    const ServoErrors errors = servo_errors(run, machine.pulses_per_mm(), "test");
    for (const ServoAxisErrors& axis : errors.axis) {
      // Plus the distance of some ticks of 1 us at 10 mm/s.
      EXPECT_LE(axis.max_pulses, 0.5 + 10 * 6.6e-6);
      EXPECT_GT(axis.max_pulses, 0.45);
      EXPECT_NEAR(axis.measured_end_mm, static_cast<double>(axis.end_pulses) * pulse_mm,
                  count_mm / 2 + 1e-9);
    }
  }
}

TEST(ServoRun, LoadsLagByTheirTimeConstants) {
  // v 2 D T along the path, plus the width of pulses and counts.
  for (const double time_constant_ms : {0.5, 5.0, 20.0}) {
    ServoMachine machine;
    machine.drive.time_constant_ms = time_constant_ms;
    const ServoRun run = run_on_servos(line_program, machine, "test");
    const double length = std::hypot(100, 150), late_s = 2 * time_constant_ms * 1e-3;
    const std::array<double, 2> speed{10 * 100 / length, 10 * 150 / length};
    const ServoErrors errors = servo_errors(run, machine.pulses_per_mm(), "test");
    for (std::size_t a = 0; a < 2; ++a) {
      EXPECT_LE(errors.axis[a].max_mm, speed[a] * late_s + (pulse_mm + count_mm) / 2 + 0.02);
      EXPECT_GE(errors.axis[a].min_mm, -(pulse_mm + count_mm) / 2 - 0.02);
      double sum = 0;
      std::size_t count = 0;
      for (const ServoSample& sample : run.samples) {
        if (sample.at_s < 2 || sample.at_s > 16) continue;
        sum += sample.axis[a].programmed - sample.axis[a].measured;
        ++count;
      }
      EXPECT_NEAR(sum / static_cast<double>(count), speed[a] * late_s, 0.01);
    }
    EXPECT_LE(errors.beside_mm, 1.5 * pulse_mm);
  }
}

TEST(ServoRun, ProgramsWithoutMotionAreRefused) {
  EXPECT_THROW(run_on_servos("G21\n", {}, "test"), Error);
  EXPECT_THROW(run_on_servos("G1 X1\n", {}, "test"), Error);  // no feed
  EXPECT_THROW(run_on_servos("G0 Z1\n", {}, "test"), Error);
}

TEST(ServoRun, MovesOfZBetweenCutsChangeNoError) {
  const auto errors_of = [](const char* text) {
    return servo_errors(run_on_servos(text, {}, "test"), ServoMachine{}.pulses_per_mm(), "test");
  };
  const ServoErrors flat = errors_of("G21 G90 G94 F600\nG1 X3 Y2\n");
  const ServoErrors lifted = errors_of("G21 G90 G94 F600\nG0 Z5\nG1 Z0\nX3 Y2\nG0 Z5\n");
  EXPECT_NEAR(lifted.beside_mm, flat.beside_mm, 1e-6);
}

TEST(ServoPicture, ShowsEveryRunWithItsName) {
  const ServoRun run = run_on_servos("G21 G90 G94 G1 X3 Y2 F600\n", {}, "test");
  const std::string picture = servo_svg({{"one & two", run}, {"three", run}}, pulse_mm);
  for (const char* const text :
       {"one &amp; two", "three", "programmed less measured / mm", "one pulse", "</svg>"})
    EXPECT_THAT(picture, HasSubstr(text));
  EXPECT_THAT(picture, testing::Not(HasSubstr("nan")));
  EXPECT_LT(picture.size(), 400'000u);
}

}  // namespace
}  // namespace lamplock::program_run::servo_errors_test
