// The operator changes the lamp's frequency in the middle of a job.
#include <functional>

#include "tests/board/board_cable.hpp"
#include "tests/board/scripted_lamp.hpp"

namespace lamplock::test {
namespace {

link::JobResult run_with(Rig& rig, const job::Job& job, Picoseconds at,
                         std::function<void()> action) {
  BoardCable cable(rig);
  cable.at(at, std::move(action));
  return link::JobSender(cable, job, session(1)).run();
}

/// Period of a lamp that the board triggers: whole ticks.
Picoseconds period_of(double hz) { return std::llround(1e6 / hz) * ps_per_us; }

TEST(ChangeOfBeat, EveryPointIsFiredOnceWheneverTheFrequencyChanges) {
  std::mt19937_64 random(91);
  for (int seed = 0; seed < scaled(16); ++seed) {
    const double other = std::array{50.0, 200.0, 80.0, 1000.0}[static_cast<std::size_t>(seed % 4)];
    const job::Profile profile = lamp_profile(100);
    const job::Job job = job_for(histogram_walk(400, static_cast<std::uint64_t>(seed)), profile,
                                 both_modes[seed / 4 % 2]);
    // The machine may get the command before or after the lamp changes.
    const auto command_at =
        static_cast<Picoseconds>(random() % 3'000) * ps_per_ms + ps_per_ms * 200;
    const auto lamp_at = command_at + (static_cast<Picoseconds>(random() % 600) - 200) * ps_per_ms;
    SCOPED_TRACE(testing::Message()
                 << "seed " << seed << ", to " << other << " Hz, command at "
                 << command_at / ps_per_ms << " ms, lamp at " << lamp_at / ps_per_ms << " ms");
    LampScript script;
    script.flash(period_of(100), lamp_at).flash(period_of(other), 30 * ps_per_s);
    Rig rig(profile.settings, dark_world());
    script.connect(rig.board);
    Result answer = Result::busy;
    const link::JobResult result = run_with(rig, job, command_at, [&] {
      answer = rig.board.controller().change_beat(static_cast<std::uint32_t>(other * 1000));
    });
    ASSERT_EQ(answer, Result::ok);
    ASSERT_EQ(result.end, JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_each_once(rig, job, true));
    EXPECT_EQ(rig.monitor.violation(profile.settings), "");
    EXPECT_FALSE(rig.board.controller().runner().underrun());
    EXPECT_EQ(rig.board.controller().shots().stray_shots(), 0u);
    const auto& reasons = result.status.beats_by_reason;
    EXPECT_EQ(std::accumulate(reasons.begin(), reasons.end(), 0u), result.status.beats);
    // The machine fires again when it has recognised the lamp.
    const Picoseconds both = std::max(command_at, lamp_at);
    const Picoseconds slower = period_of(std::min(100.0, other));
    EXPECT_GT(rig.monitor.fired(both, both + 40 * slower), 0u);
    // The changed frequency applied to this job only.
    rig.run(200 * ps_per_ms);
    EXPECT_EQ(rig.board.controller().values().milli(Id::lamp_frequency), 100'000);
    EXPECT_EQ(rig.board.controller().clock().beat_ticks(), 10'000u);
  }
}

TEST(ChangeOfBeat, WeTriggerTheLampAtTheNewFrequency) {
  for (int seed = 0; seed < scaled(8); ++seed) {
    const double other = std::array{50.0, 200.0, 90.0, 500.0}[static_cast<std::size_t>(seed % 4)];
    const LampMode mode = seed % 8 < 4 ? LampMode::master : LampMode::free_beat;
    job::Profile profile = lamp_profile(100, mode);
    job::state_setting(profile, Id::max_lamp_frequency, 1000, "test");
    const job::Job job =
        job::make_job(histogram_walk(300, static_cast<std::uint64_t>(seed)), profile, {});
    Rig rig(profile);
    const Picoseconds command_at = (300 + 137 * seed % 2000) * ps_per_ms;
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", to " << other << " Hz");
    const link::JobResult result = run_with(rig, job, command_at, [&] {
      ASSERT_EQ(rig.board.controller().change_beat(static_cast<std::uint32_t>(other * 1000)),
                Result::ok);
    });
    ASSERT_EQ(result.end, JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_each_once(rig, job, false));
    expect_sound(rig, profile.settings);
    // The period is the old one up to the change, then the new one, and never below the smaller.
    bool changed = false;
    const auto& edges = rig.monitor.edges();
    for (std::size_t i = 1; i < edges.size() && edges[i] <= rig.monitor.fires().back().edge; ++i) {
      const Picoseconds gap = edges[i] - edges[i - 1];
      if (!changed && gap == period_of(100)) continue;
      ASSERT_GE(gap, changed ? period_of(other) : std::min(period_of(100), period_of(other)));
      if (changed) {
        ASSERT_EQ(gap, period_of(other));
      }
      changed = true;
    }
    EXPECT_TRUE(changed);
  }
}

TEST(ChangeOfBeat, InAHoldAndTwiceInARow) {
  const job::Profile profile = lamp_profile(100, LampMode::master);
  const job::Job job = job::make_job(histogram_walk(300, 5), profile, {});
  Rig rig(profile);
  const link::JobResult result = run_with(rig, job, 700 * ps_per_ms, [&] {
    machine::Controller& core = rig.board.controller();
    ASSERT_EQ(core.on_command({wire::Command::hold, 0}), Result::ok);
    ASSERT_EQ(core.change_beat(50'000), Result::ok);
    rig.run(300 * ps_per_ms);
    EXPECT_EQ(core.clock().beat_ticks(), 20'000u);
    EXPECT_EQ(rig.state(), MachineState::hold);
    ASSERT_EQ(core.on_command({wire::Command::resume, 0}), Result::ok);
    rig.run(200 * ps_per_ms);
    ASSERT_EQ(core.change_beat(100'000), Result::ok);
    ASSERT_EQ(core.change_beat(200'000), Result::ok);
  });
  ASSERT_EQ(result.end, JobEnd::done);
  ASSERT_NO_FATAL_FAILURE(expect_each_once(rig, job, false));
  expect_sound(rig, profile.settings);
}

TEST(ChangeOfBeat, ImpossibleFrequenciesAreRefusedWithTheirSetting) {
  job::Profile profile = lamp_profile(100);
  job::state_setting(profile, Id::q_switch_width, 400, "test");
  const job::Job job = job::make_job(histogram_walk(200, 5), profile, {});
  Rig rig(profile);
  EXPECT_EQ(rig.board.controller().change_beat(50'000), Result::no_job);
  const link::JobResult result = run_with(rig, job, 700 * ps_per_ms, [&] {
    machine::Controller& core = rig.board.controller();
    EXPECT_EQ(core.change_beat(0), Result::bad_value);
    EXPECT_EQ(core.refused_value(), 901u);
    EXPECT_EQ(core.change_beat(8'000'001), Result::bad_value);
    EXPECT_EQ(core.refused_value(), 901u);
    // The shot would outlast the beat.
    EXPECT_EQ(core.change_beat(2'500'000), Result::bad_value);
    EXPECT_EQ(core.refused_value(), 903u);
  });
  ASSERT_EQ(result.end, JobEnd::done);
  ASSERT_NO_FATAL_FAILURE(expect_each_once(rig, job, false));
  expect_sound(rig, profile.settings);
  expect_ledger(rig, result.status);
  EXPECT_EQ(rig.board.controller().runner().misses(), 0u);
}

/// The delay from LAMP SYNC to the Q-switch is at most the setting and at most four clocks less.
TEST(QSwitchDelay, IsAccurateToATenthOfAMicrosecond) {
  std::mt19937_64 random(92);
  for (int i = 0; i < scaled(24); ++i) {
    const double fixed[] = {2.22, 7.3, 20, 2.3, 499.9, 500};
    const double delay_us = i < 6 ? fixed[i] : static_cast<double>(23 + random() % 4978) / 10;
    job::Profile profile = lamp_profile(100, i % 2 == 0 ? LampMode::slave : LampMode::master);
    job::state_setting(profile, Id::q_switch_delay, delay_us, "test");
    const job::Job job =
        job::make_job(histogram_walk(40, static_cast<std::uint64_t>(i)), profile, {});
    Rig rig(profile, {.phase_us = 1234.567 * i});
    ASSERT_EQ(run_job(rig, job).end, JobEnd::done);
    SCOPED_TRACE(testing::Message() << delay_us << " us");
    ASSERT_NO_FATAL_FAILURE(expect_each_once(rig, job, false));
    for (const PinMonitor::Fire& fire : rig.monitor.fires()) {
      const Picoseconds early =
          static_cast<Picoseconds>(std::llround(delay_us * 1e6)) - (fire.rise - fire.edge);
      ASSERT_GE(early, 0);
      ASSERT_LE(early, 4 * sim::ps_per_clock);
    }
  }
}

}  // namespace
}  // namespace lamplock::test
