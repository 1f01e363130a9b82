// Shutters, attenuator and photosensors on the real image: the shots equal those of the virtual
// board, and every shutter is closed once the e-stop is pressed.
#include "host/link/simulated_transport.hpp"
#include "sim/virtual_board/virtual_board.hpp"
#include "tests/chip_board/chip_rig.hpp"

namespace lamplock::test {
namespace {

/// Two channels with slow shutters, sensors that miss shots, an energy for each run.
struct BeamJob {
  BeamJob() {
    const auto set = [this](Id id, double value) {
      job::state_setting(profile, id, value, "test");
    };
    set(Id::shutter_open, 12);
    set(Id::shutter_close, 8);
    set(Id::attenuator_settle, 5);
    set(Id::shot_check, 2);
    set(Id::shot_repeats, 20);
    world = chip_world(profile);
    world.shutters = {12 * ps_per_ms, 8 * ps_per_ms};
    world.photosensors.failure = 0.25;
    // The shortest permitted sensor pulse; the board reads it at most 100 us later.
    world.photosensors.answer = 2 * ps_per_us;
    world.photosensors.width = 10 * ps_per_us;
    job = job::make_job(chip_points(static_cast<std::size_t>(std::max(24, scaled(40))), 3), profile,
                        {});
    for (std::size_t i = 0; i < job.targets.size(); ++i) {
      job.targets[i].channel = i / 8 % 2 == 0 ? 1 : 3;
      job.targets[i].energy =
          static_cast<std::uint16_t>(i / 5 % 3 == 2 ? 65535 : 9000 + 700 * (i / 5));
    }
  }
  job::Profile profile = chip_profile(200);
  sim::WorldConfig world;
  job::Job job;
};

/// LASER PWM has 2000 counts per period; rounding to the nearest, in units of 1/65535 for settings
/// in units of 1/65536.
constexpr double energy_rounding = 65536.0 / 2000 / 2 + 1 + 1;

TEST(ChipBeam, ChannelsEnergiesAndRepeatsAreThoseOfTheVirtualBoard) {
  const BeamJob work;
  sim::VirtualBoard board(work.profile.settings, work.world);
  link::SimulatedTransport transport(board);
  ASSERT_EQ(link::JobSender(transport, work.job, RunningJob::options(1, 0)).run().end,
            link::JobEnd::done);
  ChipRig rig(work.profile.settings, work.world);
  ASSERT_NO_FATAL_FAILURE(rig.boot());
  RunningJob running(rig, work.job, 1);
  ASSERT_EQ(running.finish(), link::JobEnd::done)
      << "hold " << static_cast<int>(running.sender.result().status.hold_reason) << ", not made "
      << running.sender.result().status.shots_not_made << " of " << rig.shots().size();
  const sim::Shots& ours = board.world().laser().shots();
  ASSERT_GT(ours.size(), work.job.targets.size());
  ASSERT_EQ(rig.shots().size(), ours.size());
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const sim::Shot& shot = rig.shots()[i];
    EXPECT_EQ(shot.channel, ours[i].channel) << "shot " << i;
    EXPECT_NEAR(shot.energy, ours[i].energy, energy_rounding) << "shot " << i;
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(shot.steps[axis], ours[i].steps[axis], 1) << "shot " << i << " axis " << axis;
  }
  EXPECT_EQ(rig.board.world().laser().stray_pulses(), 0u);
  const wire::Status& status = running.sender.result().status;
  EXPECT_EQ(status.shots_made, work.job.targets.size());
  EXPECT_EQ(status.repeats, ours.size() - work.job.targets.size());
  rig.run(20 * ps_per_ms);
  for (int c = 0; c < sim::beam_channels; ++c)
    EXPECT_FALSE(rig.board.bus().level(sim::shutter_pin(c)));
  EXPECT_FALSE(rig.energy.high_within(EnergyPads::pwm, rig.now() - 5 * ps_per_ms, rig.now()));
  expect_no_violations(rig);
}

TEST(ChipBeam, NothingIsOpenAfterAnEStop) {
  const BeamJob work;
  ChipRig rig(work.profile.settings, work.world);
  ASSERT_NO_FATAL_FAILURE(rig.boot());
  RunningJob running(rig, work.job, 1);
  ASSERT_TRUE(running.run_until_fired(5));
  EXPECT_TRUE(rig.board.bus().level(sim::Pin::shutter_2));
  EXPECT_TRUE(rig.energy.high_within(EnergyPads::pwm, rig.now() - ps_per_ms, rig.now()));
  const Picoseconds pressed = rig.now() + ps_per_us;
  rig.board.world().schedule(sim::Pin::estop, true, pressed);
  rig.board.world().schedule(sim::Pin::estop, false, pressed + 30 * ps_per_ms);
  rig.board.run_until(pressed + 10 * ps_per_us);
  for (const Picoseconds end = pressed + 60 * ps_per_ms; rig.now() < end; rig.run(50 * ps_per_us)) {
    for (int c = 0; c < sim::beam_channels; ++c)
      ASSERT_FALSE(rig.board.bus().level(sim::shutter_pin(c))) << rig.now();
  }
  EXPECT_FALSE(rig.energy.high_within(EnergyPads::pwm, pressed + 10 * ps_per_us, rig.now()));
  EXPECT_EQ(running.finish(), link::JobEnd::alarm);
}

}  // namespace
}  // namespace lamplock::test
