// Points without a shot between those with one: the machine passes them and loses no beat.
#include "tests/board/board_cable.hpp"

namespace lamplock::test {
namespace {

TEST(Waypoints, PointsWithoutAShotCostNoFlash) {
  for (std::uint64_t seed = 0; seed < static_cast<std::uint64_t>(scaled(20)); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const job::Profile profile = lamp_profile(seed % 2 == 0 ? 100 : 1000);
    job::Job job = job::make_job(histogram_walk(200, seed), profile, {});
    std::mt19937_64 random(seed);
    std::vector<StepPosition> wanted;
    for (std::size_t i = 0, left = 0; i < job.targets.size(); ++i, left -= left != 0 ? 1 : 0) {
      if (left == 0 && random() % 12 == 0)
        left = 1 + random() % 20;  // several points without a shot
      if (left != 0)
        job.targets[i].shots = 0;
      else
        wanted.push_back(job.targets[i].steps);
    }
    Rig rig(profile);
    // Plans are ready while the last one still runs.
    rig.board.set_planning_time((1 + static_cast<Picoseconds>(seed) % 4 * 10) * ps_per_ms);
    ASSERT_EQ(run_job(rig, job).end, JobEnd::done);
    ASSERT_EQ(rig.shots().size(), wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i)
      ASSERT_EQ(rig.board.lattice_shots()[i].steps, wanted[i]) << "shot " << i;
    expect_sound(rig, profile.settings);
    EXPECT_EQ(rig.board.controller().runner().misses(), 0u);
    EXPECT_EQ(rig.status().starvations, 0u);
  }
}

}  // namespace
}  // namespace lamplock::test
