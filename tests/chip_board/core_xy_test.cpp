// A CoreXY on the chip: immediate stops, after which the positions of both motors are read from the
// rings. ticks_test.cpp compares its jobs and programs with the virtual board, homing_test.cpp has
// its homing.
#include <random>

#include "tests/chip_board/chip_rig.hpp"

namespace lamplock::test {
namespace {

job::Profile core_xy() {
  job::Profile profile = chip_profile();
  profile.settings.set_milli(Id::kinematics, 1000);
  return profile;
}

/// Stops with the motors at whole steps of X and Y and between them.
TEST(ChipCoreXy, KeepsItsPositionAfterAnImmediateStop) {
  const job::Profile profile = core_xy();
  std::mt19937_64 random(7);
  int odd = 0;
  ChipRig rig(profile);
  const sim::Drives& drives = rig.board.world().drives();
  const double steps_per_mm = profile.settings.milli(Id::steps_per_mm_x) / 1000.0;
  for (int round = 0; round < scaled(4, 4); ++round) {
    rig.type("G1 X7 Y-3 F3000\nG0 X-4 Y5\nG1 X0.3 Y0.4 F2000\n");
    rig.run(static_cast<Picoseconds>(40 + random() % 150) * ps_per_ms);
    rig.board.world().schedule(sim::Pin::estop, true, rig.now() + ps_per_us);
    rig.run(20 * ps_per_ms);
    const StepPosition stood = drives.motors();
    odd += (stood[0] + stood[1]) & 1;
    // Half of the sum and of the difference of the motors' steps, to the last digit.
    const auto place = rig.reported_mm(profile.settings);
    EXPECT_NEAR(place[0], (stood[0] + stood[1]) / 2.0 / steps_per_mm, 0.51e-3);
    EXPECT_NEAR(place[1], (stood[0] - stood[1]) / 2.0 / steps_per_mm, 0.51e-3);
    rig.board.world().schedule(sim::Pin::estop, false, rig.now() + ps_per_us);
    rig.run(100 * ps_per_ms);
    EXPECT_THAT(rig.answer("$X"), HasSubstr("ok"));
    EXPECT_EQ(drives.motors(), stood);
    rig.answer("G90 G1 X1 Y2 F3000");
    rig.run(400 * ps_per_ms);  // some 10 mm at 50 mm/s
    // X + Y and X - Y.
    EXPECT_EQ(drives.motors(), (StepPosition{600, -200, 0, 0})) << "round " << round;
  }
  EXPECT_GT(odd, 0);
}

}  // namespace
}  // namespace lamplock::test
