// Pulses of a continuous laser: M126, M127, M128 and their settings.
#include <gtest/gtest.h>

#include "tests/program/refusals.hpp"
#include "tests/program/rig.hpp"

namespace lamplock::program::test::pulses_test {
namespace {

struct Laser {
  explicit Laser(std::uint32_t milli = 0) {
    options.laser = true;
    options.pulses_milli = milli;
    options.pulse_ns = 1'500'000;
  }
  Fault run(std::string_view line) {
    const Fault fault = interpreter.run(line);
    last = {};
    for (Action action; interpreter.next(action);)
      if (action.kind == ActionKind::move) last = action;
    return fault;
  }

  Parameters parameters;
  Options options;
  Interpreter interpreter{parameters, options};
  Action last;  ///< move of the line
};

TEST(Pulses, AreSwitchedByTheProgram) {
  Laser laser;
  ASSERT_FALSE(laser.run("M3 S100 F1000 G1 X1"));
  EXPECT_FALSE(laser.last.pulses);
  // On, but without a pitch: the laser is on continuously.
  ASSERT_FALSE(laser.run("M126 P1 X2"));
  EXPECT_FALSE(laser.last.pulses);
  ASSERT_FALSE(laser.run("M127 P2.5 X3"));
  EXPECT_TRUE(laser.last.pulses);
  EXPECT_EQ(laser.interpreter.pulses_milli(), 2500u);
  EXPECT_EQ(laser.interpreter.pulse_ns(), 1'500'000u);
  ASSERT_FALSE(laser.run("M128 P40.5"));
  EXPECT_EQ(laser.interpreter.pulse_ns(), 40'500u);
  ASSERT_FALSE(laser.run("M126 P0 X4"));
  EXPECT_FALSE(laser.last.pulses);
  ASSERT_FALSE(laser.run("M126 P1 G0 X5"));
  EXPECT_TRUE(laser.last.rapid);
  // An inch has 25.4 mm.
  ASSERT_FALSE(laser.run("G20 M127 P508"));
  EXPECT_EQ(laser.interpreter.pulses_milli(), 20'000u);
  ASSERT_FALSE(laser.run("M127 P0 G1 X0.2"));
  EXPECT_FALSE(laser.last.pulses);
  ASSERT_FALSE(laser.run("G21 M127 P1000"));
  EXPECT_EQ(laser.interpreter.pulses_milli(), 1'000'000u);
}

TEST(Pulses, UseTheSettingsUntilTheProgramChangesThem) {
  for (const char* end : {"M2", "M30", "reset"}) {
    Laser laser(3000);
    ASSERT_FALSE(laser.run("M4 S100 F1000 G1 X1"));
    EXPECT_TRUE(laser.last.pulses);
    EXPECT_EQ(laser.interpreter.pulses_milli(), 3000u);
    ASSERT_FALSE(laser.run("M127 P7"));
    ASSERT_FALSE(laser.run("M128 P9 X2"));
    EXPECT_EQ(laser.interpreter.pulses_milli(), 7000u);
    ASSERT_FALSE(laser.run("M126 P0 X3"));
    EXPECT_FALSE(laser.last.pulses);
    if (end == std::string_view("reset")) {
      laser.interpreter.reset();
    } else {
      ASSERT_FALSE(laser.run(end));
    }
    EXPECT_EQ(laser.interpreter.pulses_milli(), 3000u) << end;
    EXPECT_EQ(laser.interpreter.pulse_ns(), 1'500'000u) << end;
  }
  // A spindle has no pulses.
  Laser spindle(3000);
  spindle.options.laser = false;
  ASSERT_FALSE(spindle.run("M3 S100 F1000 M126 P1 G1 X1"));
  EXPECT_FALSE(spindle.last.pulses);
}

TEST(Pulses, AreSavedAndRestored) {
  Laser laser;
  ASSERT_FALSE(laser.run("M126 P1"));
  ASSERT_FALSE(laser.run("M127 P4"));
  ASSERT_FALSE(laser.run("M70"));
  ASSERT_FALSE(laser.run("M127 P5"));
  ASSERT_FALSE(laser.run("M126 P0"));
  EXPECT_EQ(laser.interpreter.pulses_milli(), 0u);
  ASSERT_FALSE(laser.run("M72"));
  EXPECT_EQ(laser.interpreter.pulses_milli(), 4000u);
}

TEST(Pulses, ErrorsChangeNothing) {
  const Refusal refusals[] = {
      {"M126", GcodeError::value_missing, 1},
      {"M126 P2", GcodeError::out_of_range, 6},
      {"M126 P0.5", GcodeError::not_integer, 6},
      {"M126 P-1", GcodeError::negative_value, 6},
      {"M127", GcodeError::value_missing, 1},
      {"M127 P-1", GcodeError::negative_value, 6},
      {"M127 P1000.001", GcodeError::out_of_range, 6},
      {"G20 M127 P25401", GcodeError::out_of_range, 10},
      {"M128", GcodeError::value_missing, 1},
      {"M128 P0", GcodeError::out_of_range, 6},
      {"M128 P0.999", GcodeError::out_of_range, 6},
      {"M128 P1000000.001", GcodeError::out_of_range, 6},
      {"M128 P-5", GcodeError::negative_value, 6},
      {"M126 P1 M127 P2", GcodeError::modal_conflict, 9},
      {"M127 P2 G4", GcodeError::axis_conflict, 6},
      {"$J=M126 P1", GcodeError::bad_jog_word, 1},
  };
  expect_refused<Laser>(refusals);
}

/// A machine with rows gets the powers first and the move with the last of them; with pulses each
/// piece is a separate move.
TEST(Pulses, RowsOfPixelsWithoutPulsesAreOneMove) {
  Laser laser;
  laser.options.rows = true;
  ASSERT_FALSE(laser.interpreter.run("G21 G90 M3 F6000 G1 X8 S10:20*5:0:400*2 N7"));
  std::vector<Action> actions;
  for (Action action; laser.interpreter.next(action);)
    if (action.kind != ActionKind::spindle) actions.push_back(action);
  ASSERT_EQ(actions.size(), 4u);
  const std::uint32_t powers[] = {10'000, 20'000, 0, 400'000};
  const int counts[] = {1, 5, 1, 2};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(actions[i].kind, i == 3 ? ActionKind::move : ActionKind::pixels);
    EXPECT_EQ(actions[i].speed_milli, powers[i]);
    EXPECT_EQ(actions[i].pixels, counts[i]);
    EXPECT_EQ(actions[i].target_e7, at(8, 0));
    EXPECT_EQ(actions[i].line, 7u);
  }
  // A single power is not a row.
  ASSERT_FALSE(laser.run("X9 S3*5"));
  EXPECT_EQ(laser.last.pixels, 0);
  EXPECT_EQ(laser.last.speed_milli, 3000u);
  ASSERT_FALSE(laser.run("M126 P1"));
  ASSERT_FALSE(laser.run("M127 P1"));
  ASSERT_FALSE(laser.interpreter.run("X11 S1:2"));
  Action action;
  ASSERT_TRUE(laser.interpreter.next(action));
  EXPECT_EQ(action.kind, ActionKind::move);
  EXPECT_EQ(action.pixels, 0);
  EXPECT_TRUE(action.pulses);
  EXPECT_EQ(action.target_e7, at(10, 0));
}

}  // namespace
}  // namespace lamplock::program::test::pulses_test
