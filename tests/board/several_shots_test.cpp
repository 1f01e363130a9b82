// Several flashes at one point, dwells, fixed beats: fired as often as ordered, whatever happens.
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
    ASSERT_EQ(result.end, link::JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_as_ordered(rig, job));
    expect_sound(rig, profile.settings);
    expect_ledger(rig, result.status);
    // On the way back from a missed flash the machine comes to a dwell as to any other place.
    if (dropouts) continue;
    EXPECT_EQ(rig.board.controller().runner().misses(), 0u);
    ASSERT_NO_FATAL_FAILURE(expect_dwells(rig, job, hz));
  }
}

/// One point, more flashes than a window holds: a flash on every beat, and not a step in between
/// but for the first and last ones.
TEST(SeveralShots, AtRestOneOnEveryBeat) {
  const job::Profile profile = lamp_profile();
  job::JobOptions options;
  options.shots = 255;
  const job::Job job = job::make_job({{1, 2, 3}}, profile, options);
  Rig rig(profile);
  ASSERT_EQ(run_job(rig, job).end, link::JobEnd::done);
  ASSERT_NO_FATAL_FAILURE(expect_as_ordered(rig, job));
  for (std::size_t i = 3; i <= 252; ++i)
    ASSERT_EQ(rig.shots()[i].beat, rig.shots()[i - 1].beat + 1) << i;
  EXPECT_FALSE(rig.monitor.stepped(rig.shots()[2].at, rig.shots()[252].at));
}

/// The highest shot rate holds for the flashes of one point too.
TEST(SeveralShots, NoFasterThanTheHighestRate) {
  job::Profile profile = lamp_profile();
  job::state_setting(profile, Id::max_shot_rate, 34, "test");  // every third beat
  job::JobOptions options;
  options.shots = 5;
  const job::Job job = job::make_job(histogram_walk(30, 3), profile, options);
  Rig rig(profile);
  ASSERT_EQ(run_job(rig, job).end, link::JobEnd::done);
  ASSERT_NO_FATAL_FAILURE(expect_as_ordered(rig, job));
  for (std::size_t i = 1; i < rig.shots().size(); ++i)
    ASSERT_GE(rig.shots()[i].beat, rig.shots()[i - 1].beat + 3) << i;
}

/// A dwell costs exactly its beats.
TEST(Dwell, OneBeatMoreIsOneBeatMore) {
  const job::Profile profile = lamp_profile();
  for (const JoinMode mode : both_modes) {
    std::vector<std::uint32_t> beats;
    for (const unsigned dwell : {1u, 2u, 7u, 300u}) {
      job::Job job = job_for(histogram_walk(40, 6), profile, mode);
      for (const std::ptrdiff_t place : {8, 17, 30}) {
        motion::Target target = job.targets[static_cast<std::size_t>(place) - 1];
        target.shots = 0;
        target.beats = static_cast<std::uint16_t>(dwell);
        job.targets.insert(job.targets.begin() + place, target);
      }
      job.header.points_total = static_cast<std::uint32_t>(job.targets.size());
      Rig rig(profile);
      const link::JobResult result = run_job(rig, job);
      ASSERT_EQ(result.end, link::JobEnd::done);
      ASSERT_NO_FATAL_FAILURE(expect_as_ordered(rig, job));
      ASSERT_NO_FATAL_FAILURE(expect_dwells(rig, job, 100));
      beats.push_back(result.status.beats - 3 * dwell);
    }
    EXPECT_EQ(beats, std::vector(4, beats[0]));
  }
}

/// A dwell that is the first target of a resumed job is gone to first.
TEST(Dwell, IsGoneToFirst) {
  const job::Profile profile = lamp_profile();
  job::Job job = job::make_job({{0, 0, 0}, {5, 5, 5}, {5, 5, 5}, {5, 6, 5}}, profile, {});
  job.targets[2].shots = 0;
  job.targets[2].beats = 20;
  Rig rig(profile);
  link::SenderOptions options;
  options.first_index = 2;
  const link::JobResult result = run_job(rig, job, options);
  ASSERT_EQ(result.end, link::JobEnd::done);
  ASSERT_EQ(rig.shots().size(), 1u);
  expect_sound(rig, profile.settings);
  // X stands from the end of the way there on, while Y waits.
  const sim::Picoseconds there = rig.monitor.steps(0).back().at;
  const auto& y = rig.monitor.steps(1);
  const auto next = std::find_if(y.begin(), y.end(), [&](const auto& s) { return s.at > there; });
  ASSERT_NE(next, y.end());
  sim::Picoseconds from = 0;
  for (const auto& s : y)
    if (s.position <= 1000) from = s.at;
  EXPECT_NEAR(static_cast<double>(next->at - from), 200e9, 12e9);
}

/// Fixed beats that no limits allow: the index of the point, whatever comes before it.
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
    link::SenderOptions sending;
    sending.session = 1;
    link::JobSender sender(transport, job, sending);
    try {
      sender.run();
      FAIL() << "it went there";
    } catch (const Error& error) {
      const std::string text = error.what();
      EXPECT_EQ(text.find("error: point " + std::to_string(wrong) + ": "), 0u) << text;
      EXPECT_EQ(text.find('\n'), std::string::npos);
      EXPECT_NE(text.find("; "), std::string::npos) << text;
    }
    expect_sound(rig, profile.settings);
    rig.run(500 * ps_per_ms);
    EXPECT_EQ(rig.state(), MachineState::idle);
    // Another job does the rest, and not one flash more.
    job.targets[wrong].beats = 0;
    job::Job rest = job;
    link::SenderOptions again;
    again.session = 2;
    again.first_index = rig.status().first_unfired;
    motion::Target& next = rest.targets[again.first_index];
    next.shots = static_cast<std::uint8_t>(next.shots - sender.result().flashes_fired);
    EXPECT_EQ(run_job(rig, rest, again).end, link::JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_as_ordered(rig, job));
  }
}

/// A job that is gone on with does not come from the target before.
TEST(FixedBeats, HoldNotFromAnywhereElse) {
  const job::Profile profile = lamp_profile();
  points::PointCloud cloud;
  for (int i = 0; i < 30; ++i) cloud.push_back({30 + 0.1 * i, 30, -30});
  job::Job job = job_for(cloud, profile, JoinMode::start_stop);
  for (motion::Target& target : job.targets) target.beats = 2;
  Rig rig(profile);
  link::SenderOptions sending;
  sending.first_index = 10;
  ASSERT_EQ(run_job(rig, job, sending).end, link::JobEnd::done);
  ASSERT_EQ(rig.shots().size(), 20u);
  for (std::size_t i = 1; i < 20; ++i)
    ASSERT_EQ(rig.shots()[i].beat, rig.shots()[i - 1].beat + 2) << i;
  expect_sound(rig, profile.settings);
}

/// After a hold the machine does not come from the target before: fixed beats do not bind it.
TEST(FixedBeats, HoldOnlyOnTheWayFromTheTargetBefore) {
  for (int seed = 0; seed < scaled(30); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const job::Profile profile = lamp_profile(100, settings::LampMode::slave, 10);
    job::Job job = job_for(histogram_walk(60, static_cast<std::uint64_t>(seed)), profile,
                           both_modes[seed % 2]);
    // 16 mm, from rest to rest in 8 beats of 10 ms, is the most.
    constexpr int far_steps = 3000;
    for (std::size_t i = 1; i < job.targets.size(); ++i) {
      bool far = false;
      for (std::size_t a = 0; a < 3; ++a)
        far = far || std::abs(job.targets[i].steps[a] - job.targets[i - 1].steps[a]) > far_steps;
      job.targets[i].beats = far ? 0 : 8;
    }
    Rig rig(profile);
    BoardCable cable(rig);
    link::SenderOptions sending;
    sending.session = 1;
    link::JobSender sender(cable, job, sending);
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    for (int i = 0; i < 12; ++i) {
      const auto at = std::uniform_int_distribution<sim::Picoseconds>(200 * ps_per_ms,
                                                                      4000 * ps_per_ms)(random);
      cable.at(at, [&cable] { cable.type("!"); });
      cable.at(at + 30 * ps_per_ms, [&cable] { cable.type("~"); });
    }
    ASSERT_EQ(sender.run().end, link::JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_as_ordered(rig, job));
    expect_sound(rig, profile.settings);
  }
}

}  // namespace
}  // namespace lamplock::test
