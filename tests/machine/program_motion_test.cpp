// Programmed places and powers in the machine's units, compared with exact arithmetic.
#include "firmware/machine/runners/program_motion.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/scale.hpp"

namespace lamplock::machine {
namespace {

using motion::full_power;
using settings::Id;

motion::LinePlace line_place(const program::Place& at, const settings::Values& values) {
  motion::LinePlace place;
  place.steps.fill(7);  // every axis is set
  place.off_q8.fill(7);
  find_place(at, values, place);
  return place;
}
motion::LineTarget line_target(const program::Action& move, const settings::Values& values) {
  motion::LineTarget line;
  find_target(move, values, line);
  return line;
}

TEST(ProgramMotion, StepsAreTheNearestOnes) {
  std::mt19937_64 random(4100);
  std::uniform_int_distribution<std::int64_t> place(-program::max_position_e7,
                                                    program::max_position_e7);
  std::uniform_int_distribution<std::int32_t> resolution(
      1, settings::row(Id::steps_per_mm_x).max_milli);
  for (int i = 0; i < test::scaled(20'000); ++i) {
    settings::Values values;
    values.set_milli(Id::axes, 4000);
    program::Place at{};
    for (int a = 0; a < max_axes; ++a) {
      const int shift = static_cast<int>(random() % 30);
      at[index(a)] = place(random) >> shift;
      ASSERT_TRUE(values.set_milli(settings::for_axis(Id::steps_per_mm_x, a),
                                   std::max(1, resolution(random) >> (random() % 20))));
    }
    const motion::LinePlace line = line_place(at, values);
    const StepPosition steps = steps_of(at, values);
    ASSERT_EQ(steps, line.steps);
    for (int a = 0; a < max_axes; ++a) {
      __extension__ using Wide = __int128;
      const Wide product = Wide{at[index(a)]} * values.milli(Id::steps_per_mm_x, a);
      const Wide unit = Wide{program::one_e7} * 1000;
      if (product > unit * max_position_steps || product < -unit * max_position_steps) {
        EXPECT_TRUE(steps[index(a)] > max_position_steps || steps[index(a)] < -max_position_steps);
        continue;
      }
      const Wide off = product - unit * steps[index(a)];
      EXPECT_LE(off < 0 ? -2 * off : 2 * off, unit);
      // To the nearest 256th except at the edges of the step; a unit of 10^10 loses its last bits.
      const int off_q8 = line.off_q8[index(a)];
      const Wide beside = 512 * off - 2 * unit * off_q8;
      EXPECT_LE(std::abs(off_q8), motion::max_off_q8);
      if (std::abs(off_q8) < motion::max_off_q8) {
        EXPECT_LE(beside < 0 ? -beside : beside, unit + 512 * 1024);
      } else {
        EXPECT_GE(off_q8 < 0 ? -beside : beside, -unit - 512 * 1024);
      }
    }
  }
}

TEST(ProgramMotion, HalfAStepIsRoundedAwayFromZero) {
  const settings::Values values;  // 200 steps/mm
  EXPECT_EQ(steps_of({25'000, -25'000, 24'999}, values), (StepPosition{1, -1, 0, 0}));
  EXPECT_EQ(steps_of({0, 0, 0, program::one_e7}, values), (StepPosition{}));  // no such axis
}

TEST(ProgramMotion, TheFractionOfAStepIsKeptExceptAtItsEdges) {
  const settings::Values values;  // 200 steps/mm
  const motion::LinePlace place = line_place({12'500, -12'500, 24'999, 0}, values);
  EXPECT_EQ(place.steps, (StepPosition{0, 0, 0, 0}));
  EXPECT_EQ(place.off_q8, (PerAxis<std::int8_t>{64, -64, 120, 0}));
  EXPECT_EQ(line_place({25'000, -25'000, 50'000, 0}, values).off_q8,
            (PerAxis<std::int8_t>{-120, 120, 0, 0}));
}

TEST(ProgramMotion, OutsideTheWorkSpaceTheAxisIsNamed) {
  const settings::Values values;  // 100 mm round zero
  const StepLimits space = work_space(values);
  EXPECT_EQ(axis_outside({10'000, -10'000, 0, 0}, space, 3), -1);
  EXPECT_EQ(axis_outside({10'000, -10'001, 0, 0}, space, 3), 1);
  EXPECT_EQ(axis_outside({10'001, -10'001, 0, 0}, space, 3), 0);
}

TEST(ProgramMotion, PowerIsRelativeToTheHighestSWord) {
  settings::Values values;
  EXPECT_EQ(power_of(0, values), 0);
  EXPECT_EQ(power_of(500'000, values), 32768);
  EXPECT_EQ(power_of(999'999, values), full_power);  // rounded to the nearest
  EXPECT_EQ(power_of(4'000'000'000, values), full_power);
  ASSERT_TRUE(values.set_milli(Id::max_spindle_speed, 255'000));
  for (std::uint32_t s = 0; s <= 255; ++s) EXPECT_EQ(power_of(s * 1000, values), s * 257);
}

TEST(ProgramMotion, LaserModeIsTheSetting) {
  program::Action move;
  move.spindle = program::Spindle::proportional;
  move.speed_milli = 1'000'000;
  move.feed_um_min = 600'000;
  move.line = 12;
  settings::Values values;
  EXPECT_EQ(line_target(move, values).laser, motion::LinePower::off);
  ASSERT_TRUE(values.set_milli(Id::laser_mode, 1000));
  const motion::LineTarget line = line_target(move, values);
  EXPECT_EQ(line.laser, motion::LinePower::proportional);
  EXPECT_EQ(line.power, full_power);
  EXPECT_EQ(line.feed_um_min, 600'000u);
  EXPECT_EQ(line.line, 12u);
  move.spindle = program::Spindle::constant;
  EXPECT_EQ(line_target(move, values).laser, motion::LinePower::constant);
  move.spindle = program::Spindle::off;
  EXPECT_EQ(line_target(move, values).laser, motion::LinePower::off);
}

}  // namespace
}  // namespace lamplock::machine
