// The flash image with drives of every kind: every point is hit, and an e-stop keeps the position.
// ticks_test.cpp compares the steps with those of the virtual board.
#include <random>

#include "tests/chip_board/pulse_kinds.hpp"

namespace lamplock::test::pulse_modes_test {
namespace {

class PulseModes : public testing::TestWithParam<Pulses> {};

TEST_P(PulseModes, JobsHitTheirPointsAndAnEmergencyStopKeepsThePlace) {
  const job::Profile machine = pulse_machine(GetParam());
  ChipRig rig(machine, ChipRig::Power::off);
  const StepLog log(machine.settings, rig.board.bus());
  rig.boot();
  std::mt19937_64 random(5);
  const int rounds = scaled(3);
  for (int round = 0; round < rounds; ++round) {
    SCOPED_TRACE(testing::Message() << "round " << round);
    RunningJob running(rig, turning_job(machine, random()), static_cast<std::uint32_t>(round + 1));
    const std::size_t before = rig.shots().size();
    ASSERT_TRUE(running.run_until_fired(30 + random() % 30));
    for (std::size_t i = before; i < rig.shots().size(); ++i)
      for (std::size_t axis = 0; axis < 3; ++axis)
        EXPECT_EQ(rig.shots()[i].steps[axis], running.job.targets[i - before].steps[axis]) << i;
    // Motion reverses at the beats: the e-stop comes soon after one.
    const Picoseconds pressed = rig.shots().at(rig.shots().size() - 1).at + 3 * ps_per_ms +
                                static_cast<Picoseconds>(random() % 60) * ps_per_us;
    ASSERT_GT(pressed, rig.now());
    rig.press(sim::Pin::estop, pressed, pressed + 5 * ps_per_ms);
    rig.board.run_until(pressed + 10 * ps_per_us);
    const StepPosition stopped = rig.board.world().drives().position();
    EXPECT_EQ(running.finish(), JobEnd::alarm);
    rig.run(60 * ps_per_ms);
    EXPECT_EQ(rig.board.world().drives().position(), stopped);
    EXPECT_EQ(rig.reported_position(machine.settings), stopped);
    EXPECT_EQ(rig.answer("$X"), "[MSG:Caution: Unlocked]\r\nok\r\n");
  }
  EXPECT_GT(log.reversals(0).size(), 30u * static_cast<unsigned>(rounds));
}

/// Low while the board does not drive the pad: with a pull-down that is off.
TEST(DrivesEnable, IsActiveHighIfTheSettingsSaySo) {
  constexpr unsigned pad = boards::gpio(boards::Role::drives_enable);
  for (const bool active_high : {false, true}) {
    job::Profile machine = chip_profile();
    machine.settings.set_milli(Id::enable_invert, active_high ? 1000 : 0);
    ChipRig rig(machine);
    const auto level = [&rig] { return (rig.board.chip().gpio().pad_levels() >> pad & 1) != 0; };
    EXPECT_EQ(level(), active_high);
    EXPECT_TRUE(rig.board.bus().level(sim::Pin::enable));
    EXPECT_EQ(rig.answer(active_high ? "$4=0" : "$4=1"), "ok\r\n");
    rig.run(20 * ps_per_ms);
    EXPECT_EQ(level(), active_high) << "must apply from the next start on";
    rig.set(sim::Pin::estop, true);
    rig.run(20 * ps_per_ms);
    EXPECT_EQ(level(), !active_high);
    EXPECT_FALSE(rig.board.bus().level(sim::Pin::enable));
  }
}

INSTANTIATE_TEST_SUITE_P(Drives, PulseModes, testing::ValuesIn(pulse_kinds),
                         [](const auto& kind) { return std::string(kind.param.name); });

}  // namespace
}  // namespace lamplock::test::pulse_modes_test
