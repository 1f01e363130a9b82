// Shutters and attenuator on the real image: every shutter is closed once the e-stop is pressed.
// ticks_test.cpp compares the shots with those of the virtual board.
#include "tests/chip_board/beam_job.hpp"

namespace lamplock::test {
namespace {

TEST(ChipBeam, NothingIsOpenAfterAnEStop) {
  const BeamJob work;
  ChipRig rig(work.profile.settings, work.world);
  RunningJob running(rig, work.job, 1);
  ASSERT_TRUE(running.run_until_fired(5));
  EXPECT_TRUE(rig.board.bus().level(sim::Pin::shutter_2));
  EXPECT_TRUE(rig.energy.high_within(EnergyPads::pwm, rig.now() - ps_per_ms, rig.now()));
  const Picoseconds pressed = rig.now() + ps_per_us;
  rig.press(sim::Pin::estop, pressed, pressed + 30 * ps_per_ms);
  rig.board.run_until(pressed + 10 * ps_per_us);
  for (const Picoseconds end = pressed + 60 * ps_per_ms; rig.now() < end; rig.run(50 * ps_per_us)) {
    for (int c = 0; c < sim::beam_channels; ++c)
      ASSERT_FALSE(rig.board.bus().level(sim::shutter_pin(c))) << rig.now();
  }
  EXPECT_FALSE(rig.energy.high_within(EnergyPads::pwm, pressed + 10 * ps_per_us, rig.now()));
  EXPECT_EQ(running.finish(), JobEnd::alarm);
}

}  // namespace
}  // namespace lamplock::test
