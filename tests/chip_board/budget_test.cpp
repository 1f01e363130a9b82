// Run time of the interrupts during a job with a busy link and a final e-stop, against the budgets
// in their headers.
#include "sim/chip_board/board_timing.hpp"
#include "tests/chip_board/chip_rig.hpp"
#include "tests/chip_board/sleep_watch.hpp"

namespace lamplock::test {
namespace {

class BeatBudgets : public testing::TestWithParam<int> {};

// Prints the numbers of the table in docs/chip-timing.md.
TEST_P(BeatBudgets, OverAJobWithABusyLink) {
  job::Profile profile = chip_profile(GetParam());
  job::set_acceleration(profile, 10);
  ChipRig rig(profile);
  const sim::BoardTiming timing(rig.board, flash_image());
  const sim::chip::Profile& measured = timing.profile();
  const job::Job job =
      job::make_job(chip_points(static_cast<std::size_t>(scaled(250)), 2), profile, {});
  RunningJob running(rig, job, 1);
  const Picoseconds end = rig.now() + running.limit();
  for (bool more = true; more && rig.now() < end;) {
    if (rig.board.usb_host().unsent() < 64) rig.type("?");
    more = running.sender.step();
  }
  EXPECT_EQ(running.sender.result().end, JobEnd::done);
  expect_fired(rig, job);
  const sim::chip::Cycle job_cycles = measured.cycles();
  const Picoseconds delay = profile.settings.milli(Id::q_switch_delay) * ps_per_us / 1000;
  std::printf("%s", sim::timing_text(timing.table(delay)).c_str());
  rig.board.world().schedule(sim::Pin::estop, true, rig.now() + ps_per_us);
  rig.run(5 * ps_per_ms);
  const auto cycles_per_us = static_cast<sim::chip::Cycle>(ps_per_us / rig.clock());
  // Interrupts are masked for at most 1 us, which is the longest wait of the e-stop.
  EXPECT_LE(measured.max_masked(), cycles_per_us);
  // From real_time.hpp; nested interrupts are included.
  const std::map<std::string, double> budget_us{
      {"IO_BANK0", 1.25}, {"TIMER_1", 40}, {"PIO0_0", 45}};
  const std::string fill = "exception 42";  // 16 + 26
  int found = 0;
  for (const sim::chip::ProfileEntry& entry : measured.exceptions()) {
    const auto budget = budget_us.find(entry.name);
    if (entry.name == fill) {
      EXPECT_LE(entry.total, job_cycles / 3);
    } else if (budget != budget_us.end()) {
      EXPECT_LE(static_cast<double>(entry.longest) / static_cast<double>(cycles_per_us),
                budget->second)
          << entry.name;
    } else {
      continue;
    }
    ++found;
  }
  EXPECT_EQ(found, 4);
  EXPECT_EQ(rig.board.chip().watchdog_resets(), 0u);
}

INSTANTIATE_TEST_SUITE_P(Lamps, BeatBudgets, testing::Values(100, 1000, 4000),
                         [](const auto& param_info) {
                           return std::to_string(param_info.param) + "Hz";
                         });

// When idle the processor sleeps most of the time and wakes with each interrupt of the beat: each
// interrupt comes 100 us after the end of the one before.
TEST(Budgets, TheMainLoopSleepsBetweenInterrupts) {
  ChipRig rig(chip_profile());
  rig.run(10 * ps_per_ms);
  const SleepWatch sleeps(rig.core());
  const sim::chip::Cycle from = rig.board.chip().now();
  rig.run(100 * ps_per_ms);
  const sim::chip::Cycle all = rig.board.chip().now() - from;
  // Some eight interrupts per millisecond end a sleep, fewer if they coincide.
  EXPECT_GT(sleeps.count(), 700);
  EXPECT_GT(sleeps.asleep(), all / 2);
}

}  // namespace
}  // namespace lamplock::test
