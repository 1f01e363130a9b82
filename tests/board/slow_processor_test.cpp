// A processor that plans slowly: jobs take longer and are otherwise the same.
#include <algorithm>

#include "tests/board/board_cable.hpp"

namespace lamplock::test {
namespace {

constexpr std::uint64_t jobs = 40;

TEST(SlowProcessor, LatePlansCostBeatsAndNothingElse) {
  std::mt19937_64 random(11);
  std::uint32_t starved = 0;
  for (std::uint64_t seed = 0; seed < static_cast<std::uint64_t>(std::max(20, scaled(jobs)));
       ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const double hz = seed % 3 == 0 ? 100 : seed % 3 == 1 ? 1000 : 250;
    const job::Profile profile = lamp_profile(hz, LampMode::slave, seed % 2 == 0 ? 2 : 10);
    const job::Job job =
        job_for(histogram_walk(250, seed), profile, both_modes[seed % 5 == 0 ? 1 : 0]);
    // Missed flashes too: the way back is planned while the machine still moves.
    Rig rig(profile, {.dropout = seed % 4 == 0 ? 0.05 : 0.0, .seed = seed});
    rig.board.set_planning_time(
        std::uniform_int_distribution<Picoseconds>(500 * ps_per_us, 400 * ps_per_ms)(random));
    ASSERT_EQ(run_job(rig, job, session(1)).end, JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_each_once(rig, job, false));
    EXPECT_EQ(rig.monitor.violation(profile.settings), "");
    expect_undisturbed(rig);
    starved += rig.status().starvations;
  }
  EXPECT_GT(starved, 0u) << "planning was never late";
}

TEST(SlowProcessor, APlanInTimeIsThePlanOfAFastOne) {
  const job::Profile profile = lamp_profile();
  const job::Job job = job::make_job(histogram_walk(300, 4), profile, {});
  std::vector<sim::Shots> shots;
  for (const Picoseconds time : {Picoseconds{0}, 30 * ps_per_ms}) {
    Rig rig(profile);
    rig.board.set_planning_time(time);
    ASSERT_EQ(run_job(rig, job).end, JobEnd::done);
    EXPECT_EQ(rig.status().starvations, 0u);
    shots.push_back(rig.shots());
  }
  ASSERT_EQ(shots[0].size(), shots[1].size());
  const std::int64_t start = shots[1][0].beat - shots[0][0].beat;
  for (std::size_t i = 0; i < shots[0].size(); ++i)
    ASSERT_EQ(shots[1][i].beat - shots[0][i].beat, start) << i;
}

/// Planning that takes slightly longer than the planned motion: the job takes about the planning
/// time, not twice that, as it would if the machine waited for every window.
TEST(SlowProcessor, KeepsUpAsWellAsItCan) {
  const job::Profile profile = lamp_profile();
  const std::size_t points = 1200;
  const job::Job job = job::make_job(histogram_walk(points, 4), profile, {});
  const auto run = [&](Picoseconds planning_time) {
    Rig rig(profile);
    rig.board.set_planning_time(planning_time);
    EXPECT_EQ(run_job(rig, job).end, JobEnd::done);
    return static_cast<double>(rig.shots().back().beat - rig.shots().front().beat);
  };
  const double beats = run(0);
  const double window_s = beats / 100 / static_cast<double>(points) * commit_points;
  const double late = run(static_cast<Picoseconds>(1.05 * window_s * ps_per_s));
  std::cout << beats << " beats, " << late << " with slow planning\n";
  EXPECT_LE(late, 1.3 * beats);
}

}  // namespace
}  // namespace lamplock::test
