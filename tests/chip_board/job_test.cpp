// Jobs on the chip: the delay of the Q-switch, and the timing of long jobs with a busy link, to the
// cycle. ticks_test.cpp compares jobs with the virtual board.
#include "sim/chip_board/board_timing.hpp"
#include "tests/chip_board/chip_rig.hpp"

namespace lamplock::test {
namespace {

/// The laser's contract is 20 us: a delay set to 20 us is never longer at the pins, wherever the
/// edge lies between two clocks.
TEST(ChipJob, TheQSwitchIsNeverLaterThanItsSetDelay) {
  job::Profile profile = chip_profile(333);  // its edges occur at every phase of a clock
  constexpr double contract_us = 20;
  constexpr Picoseconds contract = 20 * ps_per_us, clock = 8 * ps_per_ns;
  job::state_setting(profile, Id::q_switch_delay, contract_us, "test");
  ChipRig rig(profile);
  const job::Job job =
      job::make_job(chip_points(static_cast<std::size_t>(scaled(40)), 6), profile, {});
  RunningJob running(rig, job, 1);
  ASSERT_EQ(running.finish(), JobEnd::done);
  ASSERT_EQ(rig.monitor.fires().size(), job.targets.size());
  for (const PinMonitor::Fire& fire : rig.monitor.fires()) {
    EXPECT_LE(fire.rise - fire.edge, contract);
    EXPECT_GE(fire.rise - fire.edge, contract - 2 * clock);
  }
}

/// $903, at the pad.
TEST(ChipJob, TheQSwitchPulseHasItsSetWidth) {
  for (const double width_us : {1.0, 123.4, 1000.0}) {
    job::Profile profile = chip_profile(200);
    job::state_setting(profile, Id::q_switch_width, width_us, "test");
    ChipRig rig(profile);
    const job::Job job = job::make_job(chip_points(10, 6), profile, {});
    RunningJob running(rig, job, 1);
    ASSERT_EQ(running.finish(), JobEnd::done);
    ASSERT_EQ(rig.monitor.fires().size(), job.targets.size());
    rig.run(2 * ps_per_ms);  // the last pulse ends
    constexpr double two_clocks_us = 0.016 + 1e-6;
    for (const PinMonitor::Fire& fire : rig.monitor.fires())
      EXPECT_NEAR(static_cast<double>(fire.fall - fire.rise) / ps_per_us, width_us, two_clocks_us);
  }
}

struct Run {
  double lamp_hz, accel_m_s2, delay_us;
};
class LongJob : public testing::TestWithParam<Run> {};

TEST_P(LongJob, KeepsTheLatticeAndTheShotsWithABusyLink) {
  constexpr double cycle_ns = 8;
  job::Profile profile = chip_profile(GetParam().lamp_hz);
  job::set_acceleration(profile, GetParam().accel_m_s2);
  job::state_setting(profile, Id::q_switch_delay, GetParam().delay_us, "test");
  // More than any buffer holds. More than 2000 points test nothing new.
  const auto points = static_cast<std::size_t>(std::min(scaled(300), 2000));
  const job::Job job = job::make_job(histogram_walk(points, 3), profile, {});
  ChipRig rig(profile, ChipRig::Power::off);
  const sim::BoardTiming timing(rig.board, flash_image());
  rig.boot();
  RunningJob running(rig, job, 1);
  std::mt19937_64 random(4);
  const Picoseconds limit = rig.now() + 300 * ps_per_s;
  std::size_t junk = 0;
  for (bool more = true; more; more = running.sender.step()) {
    ASSERT_LT(rig.now(), limit) << rig.shots().size() << " shots";
    // Status queries and invalid lines arrive between the frames.
    if (rig.board.usb_host().unsent() != 0) continue;
    rig.type(random() % 4 == 0 ? std::string(random() % 200, 'j') + "\n" : "?");
    ++junk;
  }
  EXPECT_GT(junk, job.targets.size() / 20);
  EXPECT_EQ(running.sender.result().end, JobEnd::done);
  expect_fired(rig, job);
  EXPECT_EQ(rig.monitor.violation(profile.settings), "");
  const sim::TimingTable table =
      timing.table(profile.settings.milli(Id::q_switch_delay) * ps_per_us / 1000);
  std::printf("%s", sim::timing_text(table).c_str());
  // Two clocks are subtracted from the setting, and a fraction is rounded off
  // (lamp/shot_delay.hpp).
  EXPECT_LE(table.phase_worst_ns, 3 * cycle_ns);
  EXPECT_LE(table.step_error_worst_ns, cycle_ns);
  for (const sim::TimingTable::Stack& stack : table.stacks) {
    EXPECT_GT(stack.used, 0u);
    EXPECT_LT(stack.used, stack.size);
  }
  EXPECT_GT(table.planner_load, 0.01);
  EXPECT_LT(table.planner_load, 0.99);
  EXPECT_LE(table.max_masked_us, 1.0);
  EXPECT_EQ(rig.board.chip().watchdog_resets(), 0u);
}

INSTANTIATE_TEST_SUITE_P(Lamps, LongJob, testing::Values(Run{100, 2, 5}, Run{1000, 10, 7.3}),
                         [](const auto& param_info) {
                           return std::to_string(static_cast<int>(param_info.param.lamp_hz)) + "Hz";
                         });

}  // namespace
}  // namespace lamplock::test
