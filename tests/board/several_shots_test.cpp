// Several flashes at one point, dwells, fixed beats: every point is fired as often as ordered.
#include "host/error.hpp"
#include "tests/board/mixed_job.hpp"

namespace lamplock::test {
namespace {

TEST(SeveralShots, FiredAsOftenAsOrdered) {
  for (int seed = 0; seed < scaled(24); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const auto number = static_cast<std::uint64_t>(seed);
    const double hz = seed % 3 == 0 ? 1000 : 100;
    const job::Profile profile = lamp_profile(hz);
    const job::Job job = mixed_job(profile, 80, number, both_modes[seed % 2]);
    const bool dropouts = seed % 4 == 3;
    Rig rig(profile, {.dropout = dropouts ? 0.05 : 0.0, .seed = number + 1});
    rig.board.set_planning_time(seed % 5 * 5 * ps_per_ms);
    const link::JobResult result = run_job(rig, job);
    ASSERT_EQ(result.end, JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_as_ordered(rig, job));
    expect_sound(rig, profile.settings);
    expect_ledger(rig, result.status);
    // The return after a missed flash treats a dwell as any other place.
    if (dropouts) continue;
    EXPECT_EQ(rig.board.controller().runner().misses(), 0u);
    ASSERT_NO_FATAL_FAILURE(expect_dwells(rig, job, hz));
  }
}

/// One point with more flashes than a window holds: a flash on every beat, and steps only before
/// the first and after the last.
TEST(SeveralShots, FireOnEveryBeatAtRest) {
  const job::Profile profile = lamp_profile();
  job::JobOptions options;
  options.shots = 255;
  const job::Job job = job::make_job({{1, 2, 3}}, profile, options);
  Rig rig(profile);
  ASSERT_EQ(run_job(rig, job).end, JobEnd::done);
  ASSERT_NO_FATAL_FAILURE(expect_as_ordered(rig, job));
  for (std::size_t i = 3; i <= 252; ++i)
    ASSERT_EQ(rig.shots()[i].beat, rig.shots()[i - 1].beat + 1) << i;
  EXPECT_FALSE(rig.monitor.stepped(rig.shots()[2].at, rig.shots()[252].at));
}

/// The maximum shot rate applies to the flashes of one point too.
TEST(SeveralShots, NoFasterThanTheHighestRate) {
  job::Profile profile = lamp_profile();
  job::state_setting(profile, Id::max_shot_rate, 34, "test");  // every third beat
  job::JobOptions options;
  options.shots = 5;
  const job::Job job = job::make_job(histogram_walk(30, 3), profile, options);
  Rig rig(profile);
  ASSERT_EQ(run_job(rig, job).end, JobEnd::done);
  ASSERT_NO_FATAL_FAILURE(expect_as_ordered(rig, job));
  for (std::size_t i = 1; i < rig.shots().size(); ++i)
    ASSERT_GE(rig.shots()[i].beat, rig.shots()[i - 1].beat + 3) << i;
}

/// A dwell costs exactly its beats.
TEST(Dwell, CostsExactlyItsBeats) {
  const job::Profile profile = lamp_profile();
  for (const JoinMode mode : both_modes) {
    std::vector<std::uint32_t> beats;
    for (const unsigned dwell : {1u, 2u, 7u, 300u}) {
      job::Job job = job_for(histogram_walk(40, 6), profile, mode);
      for (const std::ptrdiff_t place : {8, 17, 30}) {
        wire::Target target = job.targets[static_cast<std::size_t>(place) - 1];
        target.shots = 0;
        target.beats = static_cast<std::uint16_t>(dwell);
        job.targets.insert(job.targets.begin() + place, target);
      }
      job.header.points_total = static_cast<std::uint32_t>(job.targets.size());
      Rig rig(profile);
      const link::JobResult result = run_job(rig, job);
      ASSERT_EQ(result.end, JobEnd::done);
      ASSERT_NO_FATAL_FAILURE(expect_as_ordered(rig, job));
      ASSERT_NO_FATAL_FAILURE(expect_dwells(rig, job, 100));
      beats.push_back(result.status.beats - 3 * dwell);
    }
    EXPECT_EQ(beats, std::vector(4, beats[0]));
  }
}

/// If a dwell is the first target of a resumed job, the machine moves there first.
TEST(Dwell, BeginsAfterTheMoveToItsPlace) {
  const job::Profile profile = lamp_profile();
  job::Job job = job::make_job({{0, 0, 0}, {5, 5, 5}, {5, 5, 5}, {5, 6, 5}}, profile, {});
  job.targets[2].shots = 0;
  job.targets[2].beats = 20;
  Rig rig(profile);
  link::SenderOptions options;
  options.first_index = 2;
  const link::JobResult result = run_job(rig, job, options);
  ASSERT_EQ(result.end, JobEnd::done);
  ASSERT_EQ(rig.shots().size(), 1u);
  expect_sound(rig, profile.settings);
  // X is at rest from the end of that move on, while Y waits.
  const Picoseconds there = rig.monitor.steps(0).back().at;
  const auto& y = rig.monitor.steps(1);
  const auto next = std::find_if(y.begin(), y.end(), [&](const auto& s) { return s.at > there; });
  ASSERT_NE(next, y.end());
  Picoseconds from = 0;
  for (const auto& s : y)
    if (s.position <= 1000) from = s.at;
  EXPECT_NEAR(static_cast<double>(next->at - from), 200e9, 12e9);
}

/// Fixed beats that limits do not permit: the error has the point's index, whatever precedes it.
TEST(FixedBeats, TooFewNameThePoint) {
  for (const std::uint32_t wrong : {1u, 7u, 8u, 20u, 39u}) {
    SCOPED_TRACE(testing::Message() << "point " << wrong);
    const job::Profile profile = lamp_profile();
    job::Job job = job::make_job(histogram_walk(40, 6), profile, {});
    job.targets[wrong].steps[0] += 4000;
    for (std::size_t i = wrong + 1; i < job.targets.size(); ++i) job.targets[i].steps[0] += 4000;
    job.targets[wrong].beats = 1;
    if (wrong > 3) job.targets[3].shots = 20;
    Rig rig(profile);
    link::SimulatedTransport transport(rig.board);
    link::JobSender sender(transport, job, session(1));
    try {
      sender.run();
      FAIL() << "the machine moved to the point";
    } catch (const Error& error) {
      const std::string text = error.what();
      EXPECT_EQ(text.find("error: point " + std::to_string(wrong) + ": "), 0u) << text;
      EXPECT_EQ(text.find('\n'), std::string::npos);
      EXPECT_NE(text.find("; "), std::string::npos) << text;
    }
    expect_sound(rig, profile.settings);
    rig.run(500 * ps_per_ms);
    EXPECT_EQ(rig.state(), MachineState::idle);
    // Another job fires exactly the rest.
    job.targets[wrong].beats = 0;
    job::Job rest = job;
    link::SenderOptions again = session(2);
    again.first_index = rig.status().first_unfired;
    wire::Target& next = rest.targets[again.first_index];
    next.shots = static_cast<std::uint8_t>(next.shots - sender.result().flashes_fired);
    EXPECT_EQ(run_job(rig, rest, again).end, JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_as_ordered(rig, job));
  }
}

/// A continued job does not start from the target before.
TEST(FixedBeats, DoNotApplyFromAnotherPlace) {
  const job::Profile profile = lamp_profile();
  geometry::PointCloud cloud;
  for (int i = 0; i < 30; ++i) cloud.push_back({30 + 0.1 * i, 30, -30});
  job::Job job = job_for(cloud, profile, JoinMode::start_stop);
  for (wire::Target& target : job.targets) target.beats = 2;
  Rig rig(profile);
  link::SenderOptions sending;
  sending.first_index = 10;
  ASSERT_EQ(run_job(rig, job, sending).end, JobEnd::done);
  ASSERT_EQ(rig.shots().size(), 20u);
  for (std::size_t i = 1; i < 20; ++i)
    ASSERT_EQ(rig.shots()[i].beat, rig.shots()[i - 1].beat + 2) << i;
  expect_sound(rig, profile.settings);
}

/// After a hold the machine does not start from the target before, so fixed beats do not apply.
TEST(FixedBeats, ApplyOnlyFromTheTargetBefore) {
  for (int seed = 0; seed < scaled(30); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const job::Profile profile = lamp_profile(100, LampMode::slave, 10);
    job::Job job = job_for(histogram_walk(60, static_cast<std::uint64_t>(seed)), profile,
                           both_modes[seed % 2]);
    // The maximum is 16 mm, from rest to rest in 8 beats of 10 ms.
    constexpr int far_steps = 3000;
    for (std::size_t i = 1; i < job.targets.size(); ++i) {
      bool far = false;
      for (std::size_t a = 0; a < 3; ++a)
        far = far || std::abs(job.targets[i].steps[a] - job.targets[i - 1].steps[a]) > far_steps;
      job.targets[i].beats = far ? 0 : 8;
    }
    Rig rig(profile);
    BoardCable cable(rig);
    link::JobSender sender(cable, job, session(1));
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    for (int i = 0; i < 12; ++i) {
      const auto at =
          std::uniform_int_distribution<Picoseconds>(200 * ps_per_ms, 4000 * ps_per_ms)(random);
      cable.at(at, [&cable] { cable.type("!"); });
      cable.at(at + 30 * ps_per_ms, [&cable] { cable.type("~"); });
    }
    ASSERT_EQ(sender.run().end, JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_as_ordered(rig, job));
    expect_sound(rig, profile.settings);
  }
}

}  // namespace
}  // namespace lamplock::test
