// The second core plans: the job is the same with and without it, and events on the first core
// during planning lose no point.
#include "tests/chip_board/chip_rig.hpp"
#include "tests/chip_board/sleep_watch.hpp"

namespace lamplock::test {
namespace {

using sim::chip::Master;
using sim::chip::Width;

constexpr std::uint32_t sram = 0x2000'0000;
constexpr const char* alone = "[MSG:Core 1 does not answer: core 0 plans]";

/// A chip with only one core, as in other simulators, from the end of the loader on.
void hold_second_core(ChipRig& rig) {
  constexpr std::uint32_t psm_frce_off = 0x4001'0004, proc1 = 1u << 16;
  for (int i = 0; i < 10'000 && rig.core().reg(15) < sram; ++i) rig.run(100 * ps_per_us);
  ASSERT_GE(rig.core().reg(15), sram);
  rig.board.chip().bus().write(psm_frce_off, proc1, Width::word, Master::core0, rig.core().cycle());
}

TEST(SecondCore, WithItAndWithoutTheJobIsTheSame) {
  const job::Profile profile = chip_profile(250);
  // Of a fixed length: in a longer job a plan of core 0 can be late, and then the machine starves.
  const job::Job job = job::make_job(histogram_walk(20, 5), profile, {});
  std::array<std::vector<Step>, 2> steps;
  for (const bool there : {false, true}) {
    ChipRig rig(profile, ChipRig::Power::off);
    if (!there) {
      ASSERT_NO_FATAL_FAILURE(hold_second_core(rig));
    }
    rig.boot();
    if (there)
      EXPECT_THAT(rig.heard, Not(HasSubstr(alone)));
    else
      EXPECT_THAT(rig.heard, HasSubstr(alone));
    const SleepWatch second(rig.board.chip().core(1));
    RunningJob running(rig, job, 1);
    ASSERT_EQ(running.finish(), JobEnd::done);
    expect_fired(rig, job, 0);
    EXPECT_EQ(running.sender.result().status.starvations, 0u);
    if (there) {
      EXPECT_GT(second.awake(), rig.board.chip().now() / 20);
    }
    EXPECT_EQ(second.interrupts(), 0);
    steps[there ? 1 : 0] = steps_of(rig.monitor, step_latency);
  }
  ASSERT_GT(steps[0].size(), 100u);
  EXPECT_EQ(steps[0], steps[1]);
}

TEST(SecondCore, WithoutItALongJobIsWhole) {
  const job::Profile profile = chip_profile(250);
  const job::Job job =
      job::make_job(histogram_walk(static_cast<std::size_t>(scaled(120)), 5), profile, {});
  ChipRig rig(profile, ChipRig::Power::off);
  ASSERT_NO_FATAL_FAILURE(hold_second_core(rig));
  rig.boot();
  ASSERT_NO_FATAL_FAILURE(run_to_the_end(rig, job));
}

class WhileItPlans : public BootedRig {
 protected:
  WhileItPlans() : BootedRig(21) {}
  /// Runs into a plan, which must begin: if none does, the job is over.
  void run_somewhere_into_a_plan() {
    ASSERT_TRUE(run_into_a_plan(rig()));
    rig().run(up_to(2 * ps_per_ms));
    in_a_plan_ += plans(rig()) ? 1 : 0;
  }
  int in_a_plan_ = 0;
};

TEST_F(WhileItPlans, HoldResetStopAndEmergencyStopLoseNoPoint) {
  std::uint32_t session = 0;
  Picoseconds judged_from = 0;
  // More points than are planned ahead: with 80 the last plan is made after a few shots.
  constexpr std::size_t points = 150;
  for (int round = 0; round < scaled(5, 5); ++round) {
    SCOPED_TRACE(testing::Message() << "round " << round);
    const std::size_t before = rig().shots().size();
    const job::Job job = job::make_job(chip_points(points, random_()), profile_, {});
    {
      RunningJob running(rig(), job, ++session);
      ASSERT_TRUE(running.run_until_fired(1 + random_() % 20));
      ASSERT_NO_FATAL_FAILURE(run_somewhere_into_a_plan());
      const int what = round % 5;
      if (what < 2) {
        rig().type(what == 0 ? "!" : "\x18");
        rig().run(up_to(40 * ps_per_ms));
        rig().type("~");
        running.sender.resume();
      } else if (what == 2) {
        running.sender.stop();
      } else if (what == 3) {
        // An e-stop stops the machine at once: the times before and after it are judged.
        EXPECT_EQ(rig().monitor.violation(profile_.settings, judged_from, rig().now()), "");
        judged_from = rig().now() + 10 * ps_per_ms;
        rig().press(sim::Pin::estop, rig().now() + ps_per_us, judged_from);
      } else {
        rig().press(sim::Pin::door, rig().now() + ps_per_us, rig().now() + 20 * ps_per_ms);
        rig().run(100 * ps_per_ms);
        running.sender.resume();
      }
      const JobEnd end = running.finish();
      if (what != 2 && what != 3) {
        EXPECT_EQ(end, JobEnd::done);
        expect_fired(rig(), job, before);
        continue;
      }
      EXPECT_EQ(end, what == 2 ? JobEnd::stopped : JobEnd::alarm);
    }
    // Settings are written to flash and a new job begins, perhaps before the slice is over.
    if (round % 5 == 3) {
      rig().run(65 * ps_per_ms);
      EXPECT_EQ(rig().answer("$X"), "[MSG:Caution: Unlocked]\r\nok\r\n");
    }
    for (const char* line : {"$929=250", "$929=200"}) EXPECT_EQ(rig().answer(line), "ok\r\n");
    const std::size_t fired = rig().shots().size() - before;
    if (round % 5 == 3) continue;  // its position differs from the job's
    RunningJob rest(rig(), job, ++session, fired);
    EXPECT_EQ(rest.finish(), JobEnd::done);
    expect_fired(rig(), job, before);
  }
  EXPECT_GT(in_a_plan_, 0);
  EXPECT_EQ(rig().board.chip().watchdog_resets(), 0u);
  EXPECT_EQ(rig().monitor.violation(profile_.settings, judged_from), "");
}

/// A debugger restarts only core 0. Core 1, which still runs code that is overwritten, must stop.
TEST_F(WhileItPlans, TheFirstCoreAloneIsRestarted) {
  rig().is_broken = true;  // a motion is cut off
  {
    RunningJob running(rig(), job::make_job(chip_points(200, random_()), profile_, {}), 1);
    ASSERT_TRUE(running.run_until_fired(3));
    ASSERT_NO_FATAL_FAILURE(run_somewhere_into_a_plan());
    running.sender.stop();
  }
  rig().heard.clear();
  rig().core().on_reset_request();
  rig().run(100 * ps_per_ms);
  rig().boot();
  EXPECT_THAT(rig().heard, HasSubstr("Started by"));
  EXPECT_THAT(rig().heard, Not(HasSubstr(alone)));
  const std::size_t fired = rig().shots().size();
  const job::Job job = job::make_job(chip_points(60, random_()), profile_, {});
  const SleepWatch second(rig().board.chip().core(1));
  RunningJob running(rig(), job, 2);
  ASSERT_EQ(running.finish(), JobEnd::done);
  EXPECT_EQ(rig().shots().size() - fired, job.targets.size());
  EXPECT_GT(second.awake(), 0u);
  EXPECT_EQ(second.interrupts(), 0);
  EXPECT_EQ(rig().board.chip().watchdog_resets(), 0u);
}

}  // namespace
}  // namespace lamplock::test
