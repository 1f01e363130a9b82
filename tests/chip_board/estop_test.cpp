// E-stop and door at random moments of a job: energy off at once, steps stopped, position exact.
#include "tests/chip_board/chip_rig.hpp"
#include "tests/figure.hpp"

namespace lamplock::test {
namespace {

constexpr Picoseconds contract = 10 * ps_per_us;

class Stops : public testing::Test {
 protected:
  Picoseconds up_to(Picoseconds most) {
    return std::uniform_int_distribution<Picoseconds>(0, most)(random_);
  }
  /// Runs a job into its middle, with the gate open for some time.
  void run_into(RunningJob& running) {
    ASSERT_TRUE(running.run_until_fired(1 + random_() % 12));
    const Picoseconds moment = running.rig.now() + ps_per_ms + up_to(4 * ps_per_ms);
    running.run_until(moment - ps_per_ms);
    open_gate(running.rig);
    running.rig.board.run_until(moment);
  }
  std::mt19937_64 random_{7};
};

TEST_F(Stops, EmergencyStopAtRandomMoments) {
  const job::Profile profile = chip_profile();
  // Steps of X are output earlier: the position counts the steps that were output.
  job::Profile lagging = profile;
  job::state_setting(lagging, Id::drive_lag_x, 2300, "test");
  ChipRig rig(profile);
  Picoseconds slowest = 0;
  int gate_was_on = 0, pulse_was_on = 0, was_moving = 0;
  for (int round = 0; round < scaled(8, 5); ++round) {
    SCOPED_TRACE(testing::Message() << "round " << round);
    const std::size_t fired = rig.shots().size();
    const job::Profile& machine = round % 2 == 0 ? profile : lagging;
    RunningJob running(rig, job::make_job(chip_points(60, random_()), machine, {}),
                       static_cast<std::uint32_t>(round + 1));
    ASSERT_NO_FATAL_FAILURE(run_into(running));
    if (round % 3 == 0) {  // in the middle of a pulse
      for (int i = 0; i < 10'000 && !rig.board.bus().level(sim::Pin::q_switch); ++i)
        rig.run(10 * ps_per_us);
      rig.run(up_to(100 * ps_per_us));
    } else if (round % 3 == 1) {  // while a continuous laser shines
      for (int i = 0; i < 100 && !rig.board.bus().level(sim::Pin::laser_gate); ++i) {
        open_gate(rig);
        rig.run(10 * ps_per_us);
      }
    }
    const Picoseconds pressed = rig.now() + ps_per_us;
    // Some presses are as short as a bounce.
    const Picoseconds released =
        pressed + (round % 4 == 0 ? 2 * ps_per_us : 10 * ps_per_ms + up_to(10 * ps_per_ms));
    rig.press(sim::Pin::estop, pressed, released);
    rig.board.run_until(pressed - ps_per_ns);
    gate_was_on += rig.board.bus().level(sim::Pin::laser_gate);
    pulse_was_on += rig.board.bus().level(sim::Pin::q_switch);
    was_moving += rig.monitor.stepped(rig.now() - ps_per_ms, rig.now());
    rig.board.run_until(pressed);
    while (rig.energy.levels() != 0 && rig.now() < pressed + ps_per_ms) rig.run(100 * ps_per_ns);
    slowest = std::max(slowest, rig.now() - pressed);
    EXPECT_LE(rig.now() - pressed, contract);
    rig.board.run_until(released + 25 * ps_per_ms);
    for (const unsigned gpio :
         {EnergyPads::q_switch, EnergyPads::gate, EnergyPads::arm, EnergyPads::pwm})
      EXPECT_FALSE(rig.energy.high_within(gpio, pressed + contract, rig.now())) << "pad " << gpio;
    // The sender gets the alarm and the place for continuing; the machine knows its position.
    EXPECT_EQ(running.finish(), JobEnd::alarm);
    EXPECT_EQ(running.sender.result().status.first_unfired, rig.shots().size() - fired);
    rig.run(40 * ps_per_ms);
    EXPECT_EQ(rig.reported_position(profile.settings), rig.board.world().drives().position());
    EXPECT_THAT(rig.status(), HasSubstr("<Alarm"));
    EXPECT_EQ(rig.answer("$X"), "[MSG:Caution: Unlocked]\r\nok\r\n");
    EXPECT_THAT(rig.status(), HasSubstr("<Idle"));
    EXPECT_FALSE(rig.monitor.stepped(pressed + contract, rig.now()));
    EXPECT_FALSE(rig.step_high());
    EXPECT_EQ(rig.monitor.fired(pressed + contract, rig.now()), 0u);
  }
  std::printf("off after %.3f us; gate on %d, pulse on %d, moving %d\n",
              static_cast<double>(slowest) / 1e6, gate_was_on, pulse_was_on, was_moving);
  EXPECT_GT(gate_was_on, 0);
  EXPECT_GT(pulse_was_on, 0);
  EXPECT_GT(was_moving, 0);
}

TEST(EmergencyStopAtRest, EndsWhenItsContactHasBeenQuiet) {
  ChipRig rig;
  rig.set(sim::Pin::estop, true);
  rig.run(100 * ps_per_ms);
  const Picoseconds released = rig.now();
  rig.board.world().schedule(sim::Pin::estop, false, released);
  while (rig.now() < released + 100 * ps_per_ms && rig.answer("$X").find("ok") == std::string::npos)
    rig.run(ps_per_ms / 4);
  expect_figure("unlocked after the release of the e-stop", rig.now() - released, 20, 25);
}

/// The main loop polls the door and may be busy planning a window; the wires of the interlock chain
/// switch the laser off earlier.
TEST_F(Stops, DoorOpensAndClosesAtRandomMoments) {
  constexpr Picoseconds notice = 60 * ps_per_ms;
  /// Braking from the highest speed within a tenth of a metre, plus ticks handed out ahead.
  constexpr Picoseconds to_rest = 250 * ps_per_ms;
  const job::Profile profile = chip_profile();
  ChipRig rig(profile);
  for (int round = 0; round < scaled(4); ++round) {
    SCOPED_TRACE(testing::Message() << "round " << round);
    const std::size_t fired = rig.shots().size();
    const job::Job job = job::make_job(chip_points(50, random_()), profile, {});
    RunningJob running(rig, job, static_cast<std::uint32_t>(round + 1));
    ASSERT_TRUE(running.run_until_fired(1 + random_() % 20));
    const Picoseconds opened = rig.now() + up_to(5 * ps_per_ms);
    const Picoseconds closed = opened + to_rest + up_to(100 * ps_per_ms);
    rig.press(sim::Pin::door, opened, closed);
    running.run_until(closed);
    EXPECT_EQ(rig.monitor.fired(opened + notice, closed), 0u);
    EXPECT_FALSE(rig.monitor.stepped(opened + to_rest, closed));
    EXPECT_LT(rig.shots().size() - fired, job.targets.size());
    rig.run(50 * ps_per_ms);
    running.sender.resume();
    EXPECT_EQ(running.finish(), JobEnd::done);
    expect_fired(rig, job, fired);
  }
  EXPECT_EQ(rig.monitor.violation(profile.settings), "");
}

}  // namespace
}  // namespace lamplock::test
