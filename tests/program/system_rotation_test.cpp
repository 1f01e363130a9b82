// Rotations of coordinate systems: G10 L2 R, alone and with G68.
#include <gtest/gtest.h>

#include "tests/program/rig.hpp"

namespace lamplock::program::system_rotation_test {
namespace {

using test::at;
using test::expect_rows;
using test::Rig;

TEST(SystemRotation, TurnsRoundTheOrigin) {
  expect_rows({
      {"G10 L2 P1 R90|X1.2345678 Y2", "rapid to -2 1.2345678 0"},
      {"G10 L2 P1 X10 Y20 R90|X1 Y2 Z3", "rapid to 8 21 3"},
      {"G10 L2 P1 X10 Y20|G10 L2 P1 R90|X1 Y2", "rapid to 8 21 0"},  // keeps the origin
      {"G10 L2 P1 R90|G10 L2 P1 X10|X1 Y2", "rapid to 8 1 0"},       // keeps the rotation
      {"G10 L2 P2 R90|X1", "rapid to 1 0 0"},
      {"G10 L2 P2 R90|G55 X1", "rapid to 0 1 0"},
      {"G10 L2 P7 R90|G54.1 P1 X1", "rapid to 0 1 0"},
      {"G10 L2 P9 R90|G59.3|G10 L2 P0 R180|X1", "rapid to -1 0 0"},
      {"G10 L2 P2 R90|G55 X1|G54 X1 Y0", "rapid to 1 0 0"},
      {"G10 L2 P1 R90|G10 L2 P1 R0|X1", "rapid to 1 0 0"},
      {"G10 L2 P1 R90|X1|G91 X1", "rapid to 0 2 0"},
      {"X5|G10 L2 P1 R90|G91 X1", "rapid to 5 1 0"},  // from the machine's position
      {"G20 G10 L2 P1 X1 R90|X1 Y0", "rapid to 25.4 25.4 0"},
      {"G10 L2 P1 X10 R90|X2 Y0|G92 X0 Y0|X1 Y1", "rapid to 9 3 0"},
      {"G10 L2 P1 R90|M2|G90 G0 X1", "rapid to 0 1 0"},
      {"G10 L2 P2 R90|G55|M2|G90 G0 X1", "rapid to 1 0 0"},
  });
}

TEST(SystemRotation, MachineCoordinatesAreNotRotated) {
  expect_rows({
      {"G10 L2 P1 R90|G53 X1 Y2", "rapid to 1 2 0"},
      {"G10 L2 P1 R90|G53 X1|Y5", "rapid to -5 0 0"},
      {"X1|G28.1|G10 L2 P1 R90|X5|G28", "rapid to 1 0 0"},
      {"X1|G28.1|G10 L2 P1 R90|G28 X5 Y0", "rapid to 0 5 0 on the way; rapid to 1 0 0"},
  });
}

/// As LinuxCNC: the position gets the coordinates of the words, the other coordinates stay.
TEST(SystemRotation, OriginsFromThePosition) {
  expect_rows({
      {"G10 L2 P1 X10 Y20 R90|X1 Y2|G10 L20 P1 X5|X5 Y2", "rapid to 8 21 0"},
      {"G10 L2 P1 X10 Y20 R90|X1 Y2|G10 L20 P1 X5|X0 Y0", "rapid to 10 16 0"},
      {"G10 L2 P2 R90|X3 Y4|G10 L20 P2 X0 Y0|G55 X1 Y0", "rapid to 3 5 0"},
      {"G10 L2 P1 X10 R90|G92 X0 Y0|G10 L20 P1 X1 Y1|X1 Y1 Z0|Z1", "rapid to 0 0 1"},
  });
}

/// G68 turns what the system results in, round a centre that stays on the machine.
TEST(SystemRotation, WithRotationOfTheProgram) {
  expect_rows({
      {"G10 L2 P1 X10 R90|G68 X0 Y0 R90|X1 Y0", "rapid to 9 0 0"},
      {"G10 L2 P1 X10 R90|G68 X2 Y0 R90|X3 Y0", "rapid to 9 2 0"},
      {"G10 L2 P1 X10 R90|X2 Y0|G68 R90|X3 Y0", "rapid to 9 2 0"},
      {"G10 L2 P1 X10 R90|X2 Y0|G91 G68 X1 R90|G90 X4 Y0", "rapid to 9 3 0"},
      {"G10 L2 P1 R90|G68 X1 Y0 R-90|X2 Y0", "rapid to 1 1 0"},
      {"G10 L2 P1 R90|G68 X0 Y0 R90|G69 X1", "rapid to 0 1 0"},
      {"G10 L2 P1 R90|G68 X0 Y0 R90|G10 L2 P1 R0|X1 Y0", "rapid to 0 1 0"},
      {"G10 L2 P2 R90|G68 X0 Y0 R90|G55 X1 Y0", "rapid to -1 0 0"},
      {"G10 L2 P1 R90|G18 G68 X0 Z0 R90|X0 Y-1 Z0", "rapid to 0 0 -1"},  // X, then from Z to X
      {"G10 L2 P1 R90|G68 X0 Y0 R90|X1|G10 L20 P1 X7 Y7|X7 Y7 Z1", "rapid to -1 0 1"},
      {"G10 L2 P2 R90|G55 G68 X0 Y0 R90|M70|G54 G69|M72|X1 Y0", "rapid to -1 0 0"},
      {"G10 L2 P2 R90|G55|M70|G54|M72|X1 Y0", "rapid to 0 1 0"},
      {"G10 L2 P2 R90|G55|M73|G54|M2|G90 G0 X1 Y0", "rapid to 0 1 0"},
  });
}

TEST(SystemRotation, ArcsAndCyclesTurnWithIt) {
  Rig rig;
  rig.run_all("F60|G10 L2 P1 R90|X10 Y0");
  rig.interpreter.run("G3 X0 Y10 I-10");
  const std::vector<Action> actions = rig.take();
  EXPECT_EQ(actions.back().target_e7, at(-10, 0));
  for (const Action& action : actions) {
    EXPECT_NEAR(std::hypot(static_cast<double>(action.target_e7[0]),
                           static_cast<double>(action.target_e7[1])) /
                    one_e7,
                10, 1e-5);
    EXPECT_GE(action.target_e7[1], 0);
  }
  EXPECT_EQ(rig.run("G81 X1 Y2 Z-1 R0"), "rapid to -2 1 0; feed 60 to -2 1 -1; rapid to -2 1 0");
}

TEST(SystemRotation, ProgramsReadIt) {
  expect_rows({
      {"G10 L2 P1 R30|G10 L2 P9 R-12.5|G53 X#5230 Y#5390 Z#5250", "rapid to 30 -12.5 0"},
      {"G10 L2 P1 X5 R90|X1 Y2|#1=#5420 #2=#5421|G53 X#1 Y#2", "rapid to 1 2 0"},
  });
}

TEST(SystemRotation, IsStoredWithItsSystem) {
  Rig rig;
  rig.run("G10 L2 P3 R7");
  EXPECT_EQ(rig.parameters.changed, 1u << 2);
  EXPECT_EQ(rig.parameters.rotations_e7[2], 70'000'000);
}

/// After a reset, and after the owner has changed the parameters.
TEST(SystemRotation, FollowsTheParameters) {
  Rig rig;
  rig.run_all("X5|G10 L2 P1 R90|G68 X0 Y0 R90");
  rig.interpreter.reset();
  EXPECT_EQ(rig.run("X1 Y0"), "rapid to 0 1 0");
  rig.parameters.rotations_e7 = {};
  rig.interpreter.set_position(at(5, 0));
  EXPECT_EQ(rig.run("G91 X1"), "rapid to 6 0 0");
}

/// A line with an error changes no rotation.
TEST(SystemRotation, ErrorsChangeNothing) {
  Rig rig;
  rig.run("G10 L2 P2 R90");
  const test::Seen before = rig.seen();
  for (const char* line :
       {"G10 L2 P1 R5 X20001", "G10 L20 P1 R5 X1", "G55 G0 X99999", "G10 L2 P1"}) {
    EXPECT_NE(rig.run(line).find('@'), std::string::npos) << line;
    EXPECT_EQ(rig.seen(), before) << line;
    EXPECT_EQ(rig.parameters.rotations_e7[0], 0) << line;
  }
}

/// After G40 the cutter is beside the contour; another rotation does not move it.
TEST(SystemRotation, KeepsTheCutterBesideTheContour) {
  for (const char* const change : {"G55", "G10 L2 P1 R90", "G68 R90"}) {
    Rig rig;
    rig.run_all("G10 L2 P2 R90|F60|G41.1 D2 G1 X10|X20|G40");
    EXPECT_EQ(rig.run(change), "") << change;
    EXPECT_EQ(rig.run("G1 Z1"), "feed 60 to 20 1 1") << change;
  }
}

}  // namespace
}  // namespace lamplock::program::system_rotation_test
