// Job speed, holds and bursts of a host in jobs with points, moves and dwells: every shot as
// ordered, in order, inside the limits, at the wanted speed.
#include <algorithm>

#include "firmware/machine/runners/job_runner.hpp"
#include "tests/board/mixed_job.hpp"

namespace lamplock::test {
namespace {

/// Settings at a job speed, for the monitor.
settings::Values slowed(const job::Profile& profile, std::uint32_t percent) {
  return machine::at_job_speed(profile.settings, profile.settings, percent);
}

TEST(JobSpeed, LimitsHoldAtEverySpeedFromTheStart) {
  for (const std::uint32_t percent : {1u, 7u, 25u, 50u, 80u, 99u, 100u}) {
    SCOPED_TRACE(testing::Message() << percent << " %");
    const job::Profile profile = lamp_profile();
    const job::Job job = mixed_job(profile, 50, percent, both_modes[percent % 2]);
    Rig rig(profile);
    link::SenderOptions options = session(1);
    options.job_speed = percent;
    const link::JobResult result = run_job(rig, job, options);
    ASSERT_EQ(result.end, JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_as_ordered(rig, job));
    expect_sound(rig, slowed(profile, percent));
    ASSERT_NO_FATAL_FAILURE(expect_dwells(rig, job, 100));
    EXPECT_EQ(rig.board.controller().runner().misses(), 0u);
    EXPECT_EQ(rig.board.controller().clock().lock_losses(), 0u);
  }
}

/// The job's limits are half the machine's: 140 % exceeds the job's limits but not the machine's.
TEST(JobSpeed, FasterThanTheJobButNotThanTheMachine) {
  const auto beats_at = [](double own_accel, std::uint32_t percent) {
    job::Profile profile = lamp_profile(200, LampMode::slave, 2);
    const job::Job job = job::make_job(histogram_walk(300, 5), profile, {});
    job::Profile own = lamp_profile(200, LampMode::slave, own_accel);
    Rig rig(own.settings, world_for(own));
    link::SenderOptions options = session(1);
    options.job_speed = percent;
    const link::JobResult result = run_job(rig, job, options);
    EXPECT_EQ(result.end, JobEnd::done);
    expect_as_ordered(rig, job);
    expect_sound(rig, machine::at_job_speed(profile.settings, own.settings, percent));
    return result.status.beats;
  };
  const std::uint32_t normal = beats_at(2, 100);
  EXPECT_EQ(beats_at(10, 100), normal);
  EXPECT_EQ(beats_at(2, 140), normal);
  EXPECT_LT(beats_at(10, 140), normal);
  EXPECT_LT(beats_at(3, 140), normal);
  EXPECT_LE(beats_at(10, 140), beats_at(3, 140));
  EXPECT_GT(beats_at(10, 70), normal);
}

/// Moves that take `beats` at s % equal moves of beats x 100 / s at 100 %: rest to rest, rounded.
TEST(JobSpeed, HalfTheSpeedIsTwiceTheBeats) {
  const job::Profile profile = lamp_profile(1000);
  const job::Job job = job_for(histogram_walk(100, 5), profile, JoinMode::start_stop);
  std::vector<double> beats;
  for (const std::uint32_t percent : {100u, 50u, 25u}) {
    Rig rig(profile);
    link::SenderOptions sending = session(1);
    sending.job_speed = percent;
    beats.push_back(run_job(rig, job, sending).status.beats);
  }
  EXPECT_NEAR(beats[1] / beats[0], 2, 0.1);
  EXPECT_NEAR(beats[2] / beats[0], 4, 0.2);
}

/// A move too long for the slowest speeds is run, not refused.
TEST(JobSpeed, TheSlowestSpeedStillArrives) {
  const job::Profile profile = lamp_profile(4000);
  geometry::PointCloud cloud;
  for (int i = 0; i < 120; ++i)  // long moves among short ones
    cloud.push_back({i / 50 % 2 == 0 ? 0.0 : 50.0, i * 0.005, i * -0.01});
  const job::Job job = job::make_job(cloud, profile, {});
  Rig rig(profile);
  link::SenderOptions options = session(1);
  options.job_speed = 1;
  ASSERT_EQ(run_job(rig, job, options).end, JobEnd::done);
  ASSERT_NO_FATAL_FAILURE(expect_as_ordered(rig, job));
  expect_sound(rig, profile.settings);
}

/// Braking from a fast plan after the speed was reduced leads no further out than planned.
TEST(JobSpeed, ReducedAndHeldAtTheEdgeOfTheWorkArea) {
  for (int seed = 0; seed < scaled(8); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const auto number = static_cast<std::uint64_t>(seed);
    std::mt19937_64 random(number);
    const job::Profile profile = lamp_profile(100, LampMode::slave, 2);
    geometry::PointCloud cloud;
    for (int i = 0; i < 20; ++i) cloud.push_back({i % 2 == 0 ? -50.0 : 50.0, -50.0 + i, 0});
    const job::Job job = job::make_job(cloud, profile, {});
    Rig rig(profile);
    BoardCable cable(rig);
    link::SenderOptions options = session(1);
    options.auto_resume = true;
    link::JobSender sender(cable, job, options);
    for (Picoseconds at = 300 * ps_per_ms; at < 8 * ps_per_s;) {
      at += std::uniform_int_distribution<Picoseconds>(0, 700 * ps_per_ms)(random);
      const auto percent = static_cast<std::uint32_t>(random() % 2 == 0 ? 15 : 100);
      cable.at(at, [&sender, percent] { sender.set_job_speed(percent); });
      at += std::uniform_int_distribution<Picoseconds>(0, 300 * ps_per_ms)(random);
      cable.at(at, [&cable] { cable.type("!"); });
    }
    cable.at(9 * ps_per_s, [&sender] { sender.set_job_speed(100); });
    ASSERT_EQ(sender.run().end, JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_as_ordered(rig, job));
    expect_sound(rig, profile.settings);
  }
}

/// Committed motion runs as planned; later motion keeps the new limits; no flash is lost.
TEST(JobSpeed, TakesEffectAfterCommittedMotion) {
  for (int seed = 0; seed < scaled(20); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const auto number = static_cast<std::uint64_t>(seed);
    const job::Profile profile = lamp_profile(seed % 2 == 0 ? 100 : 500);
    job::Job job = job_for(histogram_walk(200, number), profile, both_modes[seed / 2 % 2]);
    constexpr std::size_t resting = 150;  // its third flash finds the machine at rest
    job.targets[resting].shots = 6;
    Rig rig(profile);
    BoardCable cable(rig);
    link::JobSender sender(cable, job, session(1));
    while (sender.step() && rig.shots().size() < 40) {
    }
    constexpr std::uint32_t percent = 30;
    const std::size_t before = rig.shots().size();
    sender.set_job_speed(percent);
    ASSERT_EQ(sender.run().end, JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_as_ordered(rig, job));
    expect_sound(rig, profile.settings);
    EXPECT_EQ(rig.board.controller().runner().misses(), 0u);
    // The segments in the queue are committed; one window more may need the old limits.
    ASSERT_LT(before + stepper::SegmentQueue::capacity + window_points, resting);
    EXPECT_EQ(rig.monitor.violation(slowed(profile, percent), rig.shots()[resting + 2].at), "");
    EXPECT_NE(rig.monitor.violation(slowed(profile, percent), 0, rig.shots()[before].at), "");
  }
}

/// In a straight row no state meets the slower limits: the motion is interrupted once.
TEST(JobSpeed, SlowsDownWhereTheMachineNeverSlowsByItself) {
  job::Profile profile = lamp_profile(200, LampMode::slave, 10);
  job::set_speed(profile, 0.06);
  geometry::PointCloud row;
  for (int i = 0; i < 390; ++i) row.push_back({-49 + 0.25 * i, 0, 0});
  const job::Job job = job::make_job(row, profile, {});
  Rig rig(profile);
  BoardCable cable(rig);
  link::JobSender sender(cable, job, session(1));
  while (sender.step() && rig.shots().size() < 60) {
  }
  sender.set_job_speed(50);
  ASSERT_EQ(sender.run().end, JobEnd::done);
  ASSERT_NO_FATAL_FAILURE(expect_as_ordered(rig, job));
  expect_sound(rig, profile.settings);
  const auto beats = [&rig](std::size_t from, std::size_t to) {
    return rig.shots()[to].beat - rig.shots()[from].beat;
  };
  EXPECT_EQ(beats(30, 60), 30);
  const std::size_t slow = 60 + stepper::SegmentQueue::capacity + 2 * window_points;
  EXPECT_GE(beats(slow, 389), static_cast<std::int64_t>(389 - slow) * 8 / 5);
  EXPECT_EQ(rig.monitor.violation(slowed(profile, 50), 0, rig.shots()[60].at).empty(), false);
}

/// Holds, drop-outs and other speeds at any moment.
TEST(HoldAndResume, EveryPointAsOrderedAndNoShotInBetween) {
  int holds = 0;
  for (int seed = 0; seed < scaled(150); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const auto number = static_cast<std::uint64_t>(seed);
    std::mt19937_64 random(number);
    const Pick<Picoseconds> pick(random);
    const job::Profile profile = lamp_profile(seed % 3 == 0 ? 500 : 100);
    const job::Job job = mixed_job(profile, 60, number, both_modes[seed % 2]);
    Rig rig(profile, {.dropout = seed % 4 == 3 ? 0.03 : 0.0, .seed = number + 1});
    rig.board.set_planning_time(seed % 5 * 4 * ps_per_ms);
    BoardCable cable(rig);
    link::JobSender sender(cable, job, session(1));
    // Times at which the machine was certainly in hold.
    std::vector<std::pair<Picoseconds, Picoseconds>> held;
    for (Picoseconds at = 110 * ps_per_ms + pick(0, 50 * ps_per_ms); at < 4 * ps_per_s;) {
      const Picoseconds from = at, to = from + 12 * ps_per_ms + pick(0, 60 * ps_per_ms);
      cable.at(from, [&sender] { sender.pause(); });
      cable.at(from + 10 * ps_per_ms, [&held, &rig, from, to] {
        if (rig.state() == MachineState::hold) held.emplace_back(from + 10 * ps_per_ms, to);
      });
      cable.at(to, [&sender] { sender.resume(); });
      // Too short for the sender: a byte resumes before, during and after coming to rest.
      const Picoseconds again = to + 20 * ps_per_ms + pick(0, 50 * ps_per_ms);
      cable.at(again, [&cable] { cable.type("!"); });
      cable.at(again + pick(0, 5 * ps_per_ms), [&cable] { cable.type("~"); });
      const auto percent = static_cast<std::uint32_t>(pick(10, 140));
      cable.at(to + pick(0, 20 * ps_per_ms), [&sender, percent] { sender.set_job_speed(percent); });
      at = to + 100 * ps_per_ms + pick(0, 250 * ps_per_ms);
    }
    ASSERT_EQ(sender.run().end, JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_as_ordered(rig, job));
    expect_sound(rig, profile.settings);
    for (const auto& [from, to] : held) EXPECT_EQ(rig.monitor.fired(from, to), 0u);
    holds += static_cast<int>(held.size());
  }
  EXPECT_GT(holds, scaled(150) * 3);
}

/// The host delivers at random times: the machine stops in time and resumes by itself.
TEST(Starvation, BurstsOfPointsCostBeatsAndNothingElse) {
  std::uint32_t starved = 0;
  for (int seed = 0; seed < std::max(8, scaled(20)); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const auto number = static_cast<std::uint64_t>(seed);
    std::mt19937_64 random(number);
    job::Profile profile = lamp_profile(seed % 3 == 0 ? 1000 : 100);
    profile.settings.set_milli(Id::dead_man, 0);
    const job::Job job = mixed_job(profile, 1500, number, both_modes[seed % 2]);
    Rig rig(profile, {.dropout = seed % 4 == 3 ? 0.03 : 0.0, .seed = number + 1});
    rig.board.set_planning_time(seed % 5 * 4 * ps_per_ms);
    BoardCable cable(rig);
    link::JobSender sender(cable, job, session(1));
    bool more = true;
    while (more) {
      // A few steps of the sender, then a pause.
      for (auto steps = random() % 4; more && steps-- > 0;) more = sender.step();
      rig.run(std::uniform_int_distribution<Picoseconds>(0, 400 * ps_per_ms)(random));
    }
    ASSERT_EQ(sender.result().end, JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_as_ordered(rig, job));
    expect_sound(rig, profile.settings);
    starved += rig.status().starvations;
  }
  EXPECT_GT(starved, 0u);
}

}  // namespace
}  // namespace lamplock::test
