// The interpreter, code by code: the actions of a line after preceding lines.
#include "firmware/program/interpreter.hpp"

#include <gtest/gtest.h>

#include "tests/program/rig.hpp"

namespace lamplock::program::interpreter_codes_test {
namespace {

using test::expect_rows;
using test::Rig;
using test::Row;

TEST(Interpreter, StraightMoves) {
  expect_rows({
      {"", ""},
      {"G0 X1 Y2 Z3", "rapid to 1 2 3"},
      {"G0X1Y2Z3A4", "rapid to 1 2 3 4"},
      {"X5", "rapid to 5 0 0"},  // G0 is the initial mode
      {"G0", ""},
      {"G1 F100 X1", "feed 100 to 1 0 0"},
      {"G1 F100", ""},
      {"G1 F100|X1|Y2", "feed 100 to 1 2 0"},
      {"G1 F100 X1|G0 Y2", "rapid to 1 2 0"},
      {"G1 F0.001 X1", "feed 0.001 to 1 0 0"},
      {"G1 F4294967 X1", "feed 4294967 to 1 0 0"},
      {"g01 f1500.5 x-1.2345678", "feed 1500.5 to -1.2345678 0 0"},
      {"G1 F100 X0", "feed 100 to 0 0 0"},  // a move of zero length may be a shot
      {"G1 F100 X1 N7", "feed 100 to 1 0 0 N7"},
      {"N10000000 G0 X1", "rapid to 1 0 0 N10000000"},
      {"N5|G0 X1", "rapid to 1 0 0"},
      {"/G0 X1", "rapid to 1 0 0"},
      {"% G0 X1", "rapid to 1 0 0"},
      {"T5 G0 X1 (tool)", "rapid to 1 0 0"},
      {"G0 X10000", "rapid to 10000 0 0"},
  });
}

TEST(Interpreter, UnitsAndDistances) {
  expect_rows({
      {"G20 G0 X1 Y0.000001", "rapid to 25.4 0.0000254 0"},
      {"G20 G0 X0.0000001", "rapid to 0.0000025 0 0"},
      {"G20 G0 X-0.0000001", "rapid to -0.0000025 0 0"},
      {"G20 G0 A1", "rapid to 0 0 0 25.4"},
      {"G20|G21|X1", "rapid to 1 0 0"},
      {"X1 G20", "rapid to 25.4 0 0"},
      {"G20 G1 F10 X1", "feed 254 to 25.4 0 0"},
      {"G1 F10|G20 X1", "feed 10 to 25.4 0 0"},
      {"G91 X1|X1", "rapid to 2 0 0"},
      {"X5|G91 X-1 Y2|G90 Y1", "rapid to 4 1 0"},
      {"G91 G20 X1|G21 X1", "rapid to 26.4 0 0"},
  });
}

TEST(Interpreter, FeedModes) {
  expect_rows({
      {"G93 G1 X1 F2", "feed 30000000us to 1 0 0"},
      {"G93 G1 X1 F2|X2 F4", "feed 15000000us to 2 0 0"},
      {"G93 G1 X1 F3", "feed 20000000us to 1 0 0"},
      {"G93 G1 X1 F7", "feed 8571429us to 1 0 0"},
      {"G93 G1 X1 F999999999", "feed 1us to 1 0 0"},
      {"G93 G0 X1", "rapid to 1 0 0"},
      {"G93 G20 G1 X1 F2", "feed 30000000us to 25.4 0 0"},
      {"G93 F2", ""},
      {"G95 S1000 G1 F0.05 X1", "feed 50 to 1 0 0"},
      {"G95 S1000 G1 F0.05|S500|X1", "feed 25 to 1 0 0"},
      {"G95 G20 S100 G1 F0.001 X1", "feed 2.54 to 25.4 0 0"},
      {"G94 F100 G1 X1|G94 X2", "feed 100 to 2 0 0"},
  });
}

TEST(Interpreter, Dwell) {
  expect_rows({
      {"G4 P0", "dwell 0us"},
      {"G4 P1.5", "dwell 1500000us"},
      {"G4 P0.0000005", "dwell 1us"},
      {"G4 P4294.967295", "dwell 4294967295us"},
      {"G1 F100|G4 P1 X1", "dwell 1000000us; feed 100 to 1 0 0"},
      {"X1 G4 P1 M3 M8 S5 M0",
       "spindle M3 S5; coolant flood; dwell 1000000us; rapid to 1 0 0 M3 S5; pause"},
  });
}

TEST(Interpreter, SpindleAndCoolant) {
  expect_rows({
      {"M3 S1000", "spindle M3 S1000"},
      {"S1000|M4", "spindle M4 S1000"},
      {"M3 S1000|M5", "spindle M5"},
      {"S0.5", ""},  // spindle is off
      {"M3 S1|S2", "spindle M3 S2"},
      {"M3 S1|G1 F60 X1 S2", "spindle M3 S2; feed 60 to 1 0 0 M3 S2"},
      {"M3 S1|X1", "rapid to 1 0 0 M3 S1"},
      {"M8", "coolant flood"},
      {"M8|M7", "coolant mist flood"},
      {"M8|M7|M9", "coolant"},
      {"M8|M8", "coolant flood"},
  });
}

TEST(Interpreter, LaserModeSendsSpeedsWithTheMoves) {
  Rig rig;
  rig.options.laser = true;
  EXPECT_EQ(rig.run("M4 S100"), "spindle M4 S100");
  EXPECT_EQ(rig.run("G1 F60 X1 S200"), "feed 60 to 1 0 0 M4 S200");
  EXPECT_EQ(rig.run("G0 X0 S50"), "rapid to 0 0 0 M4 S50");
  EXPECT_EQ(rig.run("S300"), "spindle M4 S300");
  EXPECT_EQ(rig.run("G28.1 S300"), "spindle M4 S300");
}

/// The spindle is off after a tool change unless the same line starts it.
TEST(Interpreter, ToolChange) {
  expect_rows({
      {"T3 M6", "tool"},
      {"M3 S5|T1 M6|X1", "rapid to 1 0 0"},
      {"M6 T2 M3 S5", "tool; spindle M3 S5"},
      {"T1 M6 G0 X1 M8", "tool; coolant flood; rapid to 1 0 0"},
  });
}

TEST(Interpreter, StopsAndEnds) {
  expect_rows({
      {"M0", "pause"},
      {"M1", "pause"},
      {"X1 M0", "rapid to 1 0 0; pause"},
      {"M2", "end"},
      {"M30", "end"},
      {"G1 F10 X1 M3 S5 M30", "spindle M3 S5; feed 10 to 1 0 0 M3 S5; end"},
      {"G1 F10 X1 M3 M2|X2", "feed 10 to 2 0 0"},
  });
}

TEST(Interpreter, EndOfProgramResetsWhatGrblResets) {
  Rig rig;
  rig.run("G20 G18 G91 G90.1 G93 G55 G64 P0.1 G99 M3 S100 M8 T3 G0");
  rig.run("M130 P1");
  rig.run("G43.1 Z1");
  rig.run("G68 R10");
  rig.run("M30");
  Modal wanted;
  wanted.motion = Motion::line;
  wanted.inches = true;
  wanted.centres_absolute = true;
  wanted.path = PathMode::blend;
  wanted.blend_um = 2540;
  wanted.retract_to_r = true;
  wanted.speed_milli = 100'000;
  wanted.tool = 3;
  wanted.tool_length = true;
  EXPECT_EQ(rig.interpreter.modal(), wanted);
}

TEST(Interpreter, PathModes) {
  expect_rows({
      {"G61 X1", "rapid to 1 0 0"},
      {"G61.1 X1", "rapid to 1 0 0 stop"},
      {"G61.1 X1|X2", "rapid to 2 0 0 stop"},
      {"G64 P0.05 X1", "rapid to 1 0 0 blend 50"},
      {"G64 P0.05 X1|G61 X2", "rapid to 2 0 0"},
      {"G64 P0.05 X1|G64 X2", "rapid to 2 0 0"},
      {"G20 G64 P0.001 X1", "rapid to 25.4 0 0 blend 25"},
      {"G9 X1", "rapid to 1 0 0 stop"},
      {"G9 X1|X2", "rapid to 2 0 0"},
  });
  Rig rig;
  rig.options.blend_um = 20;
  EXPECT_EQ(rig.run("G64 X1"), "rapid to 1 0 0 blend 20");
}

TEST(Interpreter, BeatLock) {
  expect_rows({
      {"M130 P0", "beat path"},
      {"M130 P1", "beat free"},
      {"M130 P1|M131", "beat off"},
      {"M130 P0 G1 F60 X1", "beat path; feed 60 to 1 0 0 beat"},
      {"M130 P1|G1 F60 X1|X2", "feed 60 to 2 0 0 free"},
      {"M130 P1|M131|X1", "rapid to 1 0 0"},
  });
}

TEST(Interpreter, CodesThatChangeNothing) {
  expect_rows({
      {"G40", ""},
      {"G40 X1", "rapid to 1 0 0"},
      {"G49", ""},
      {"M48", "overrides on"},
      {"M49", "overrides off"},
      {"M60", "pause"},
      {"M61 Q3", ""},
      {"G64 P0.1 Q0.02", ""},
      {"G80", ""},
      {"G21 G90 G94 G17 G54 G91.1 G98 G69", ""},
      {"G1.0 F100 X1", "feed 100 to 1 0 0"},
      {"G01.00 F100 X1", "feed 100 to 1 0 0"},
      {"G54.0 X1", "rapid to 1 0 0"},
      {"M05", "spindle M5"},
      {"M5.0", "spindle M5"},
  });
}

/// Words of other controllers: each is noted once in a program, and the rest of the line acts.
TEST(Interpreter, WordsWithoutEffect) {
  struct Case {
    const char* line;
    const char* actions;
    const char* noted;
  };
  constexpr Case cases[] = {
      {"O1000", "", "O "},
      {"o12 (a part)", "", "O "},
      {":1000", "", "O "},
      {":1000 G0 X1", "rapid to 1 0 0", "O "},
      {"G0 X1 D1", "rapid to 1 0 0", "D "},
      {"H2 G0 X1", "rapid to 1 0 0", "H "},
      {"G15 G97 G0 X1 S9", "rapid to 1 0 0", "G15 G97 "},
      {"G50", "", "G50 "},
      {"G0 X1 M117 50% of X2", "rapid to 1 0 0", "M117 "},
      {"m117", "", "M117 "},
      {"M117", "", "M117 "},
  };
  for (const Case& c : cases) {
    Rig rig;
    EXPECT_EQ(rig.run(c.line), c.actions) << c.line;
    const unsigned words = rig.interpreter.take_ignored();
    std::string noted;
    for (std::size_t i = 0; i < std::size(ignored_words); ++i)
      if ((words >> i & 1u) != 0) noted += std::string(ignored_words[i]) + " ";
    EXPECT_EQ(noted, c.noted) << c.line;
    rig.run(c.line);
    EXPECT_FALSE(rig.interpreter.has_ignored()) << c.line;
    rig.run("M2");
    rig.run(c.line);
    EXPECT_EQ(rig.interpreter.has_ignored(), noted != "") << c.line;
  }
}

TEST(Interpreter, SavedState) {
  expect_rows({
      {"G20 G91|M70|G21 G90|M72|X1", "rapid to 25.4 0 0"},
      {"G20|M70|G21|M72|G21|M72|X1", "rapid to 25.4 0 0"},
      {"G20|M70|M72 G21 X1", "rapid to 1 0 0"},
      {"G20 M70|M72|X1", "rapid to 1 0 0"},  // saved before the rest of its line
      {"M70|M71|M72", "20@1"},
      {"M72", "20@1"},
      {"G1 F50|M70|F100 G0|M72|X1", "rapid to 1 0 0"},  // motion mode is not saved
      {"G1 F50|M70|F100|M72|X1", "feed 50 to 1 0 0"},
      {"M3 S5|M70|M5|M72", "spindle M3 S5"},
      {"M8|M70|M9|M72", "coolant flood"},
      {"M130 P1|M70|M131|M72", "beat free"},
      {"M70|M72", ""},
      {"G20|M73|G21|M72|X1", "rapid to 25.4 0 0"},
      {"G20|M73|G21|M2|G0 X1", "rapid to 25.4 0 0"},
      {"G20|M70|G21|M2|G0 X1", "rapid to 1 0 0"},
      {"M3 S5|M73|M2|G0 X1", "rapid to 1 0 0"},  // nothing restarts automatically
      {"M73|M2|M72", "20@1"},
      {"G68 R90|M70|G69|M72|X1", "rapid to 0 1 0"},
  });
}

TEST(Interpreter, Jog) {
  Rig rig;
  rig.options.probe = true;
  rig.run_all("G20 G1 F10 M3 S5 M130 P0|G64 P1");
  rig.run("G81");  // an error, which changes nothing
  EXPECT_EQ(rig.jog("X1 F1"), "feed 25.4 to 25.4 0 0");
  EXPECT_EQ(rig.jog("G21 G91 X1 Y-1 F100"), "feed 100 to 26.4 -1 0");
  EXPECT_EQ(rig.jog("g91g21z2f60n4"), "feed 60 to 26.4 -1 2 N4");
  EXPECT_EQ(rig.jog("X0 F1"), "feed 25.4 to 0 -1 2");  // G90 and G20 still apply
  rig.run("G10 L2 P1 X5 Y5");
  EXPECT_EQ(rig.jog("G53 G21 X1 F60"), "feed 60 to 1 -1 2");
  EXPECT_EQ(rig.jog("G21 X1 F60"), "feed 60 to 128 -1 2");
  EXPECT_EQ(rig.run("G21"), "");
  EXPECT_EQ(rig.run("X0"), "feed 254 to 127 -1 2 M3 S5 beat blend 25400");
}

TEST(Interpreter, JogErrors) {
  const Row rows[] = {
      {"X1", "22@1"},        {"X1 F0", "22@1"},      {"F100", "26@1"},
      {"", "26@1"},          {"G1 X1 F1", "16@1"},   {"X1 F1 G2", "16@7"},
      {"G17 X1 F1", "16@1"}, {"G54 X1 F1", "16@1"},  {"G93 X1 F1", "16@1"},
      {"G28 X1 F1", "16@1"}, {"X1 M3 F1", "16@4"},   {"X1 F1 S5", "16@7"},
      {"X1 F1 I5", "16@7"},  {"X1 F1 P5", "16@7"},   {"X1 F1 T1", "16@7"},
      {"X1 F1 B1", "20@7"},  {"X1 F1 X2", "25@7"},   {"X1 F-1", "4@4"},
      {"X F1", "2@1"},       {"X1 F1 !", "1@7"},     {"G90 G91 X1 F1", "21@5"},
      {"X10001 F1", "33@1"}, {"G999 X1 F1", "20@1"},
  };
  Rig rig;
  for (const Row& row : rows) {
    const test::Seen before = rig.seen();
    EXPECT_EQ(rig.jog(row.lines), row.wanted) << row.lines;
    EXPECT_EQ(rig.seen(), before) << row.lines;
  }
}

TEST(Interpreter, Probe) {
  Rig rig;
  EXPECT_EQ(rig.run("G38.2 Z-5 F60"), "20@1");
  rig.options.probe = true;
  EXPECT_EQ(rig.run("G38.2 Z-5 F60"), "probe must 60 to 0 0 -5");
  rig.interpreter.set_position(test::at(0, 0, -3));
  EXPECT_EQ(rig.run("G91 G38.3 Z-1"), "probe 60 to 0 0 -4");
  EXPECT_EQ(rig.run("G38.4 Z1"), "probe away must 60 to 0 0 -3");
  EXPECT_EQ(rig.run("G38.5 Z1"), "probe away 60 to 0 0 -2");
  EXPECT_EQ(rig.run("G38.2 Z0"), "33@1");
  EXPECT_EQ(rig.run("G38.2"), "26@1");
  EXPECT_EQ(rig.run("F0 G38.2 Z1"), "22@4");
}

TEST(Interpreter, GivesActionsOneAtATime) {
  Rig rig;
  EXPECT_FALSE(rig.interpreter.busy());
  EXPECT_FALSE(rig.interpreter.run("M3 S1 X1"));
  EXPECT_TRUE(rig.interpreter.busy());
  Action action;
  EXPECT_TRUE(rig.interpreter.next(action));
  EXPECT_EQ(action.kind, ActionKind::spindle);
  EXPECT_TRUE(rig.interpreter.busy());
  EXPECT_TRUE(rig.interpreter.next(action));
  EXPECT_EQ(action.kind, ActionKind::move);
  EXPECT_FALSE(rig.interpreter.busy());
  EXPECT_FALSE(rig.interpreter.next(action));
}

TEST(Interpreter, ResetAndPosition) {
  Rig rig;
  rig.run("G20 G91 G55 M3 S5 G1 F10");
  rig.run("X1");
  rig.run("G92 X0");
  EXPECT_FALSE(rig.interpreter.run("X1 Y1"));
  rig.interpreter.reset();
  EXPECT_FALSE(rig.interpreter.busy());
  EXPECT_EQ(rig.interpreter.modal(), Modal{});
  rig.interpreter.set_position(test::at(1, 2, 3, 4));
  EXPECT_EQ(rig.run("Y5"), "rapid to 1 5 3 4");
}

TEST(Interpreter, AxesThatTheMachineLacks) {
  Rig rig;
  rig.options.axes = 3;
  EXPECT_EQ(rig.run("X1 A1"), "20@4");
  rig.options.axes = 2;
  EXPECT_EQ(rig.run("X1 Z1"), "20@4");
  EXPECT_EQ(rig.run("X1 Y1"), "rapid to 1 1 0");
}

}  // namespace
}  // namespace lamplock::program::interpreter_codes_test
