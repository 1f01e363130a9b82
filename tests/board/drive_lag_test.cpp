// Drives that lag after their steps: with their lags set, all loads are on the point at the shot.
#include "tests/board/rig.hpp"

namespace lamplock::test::drive_lag_test {
namespace {

constexpr JoinMode all_modes[] = {JoinMode::free, JoinMode::path, JoinMode::start_stop};
constexpr std::uint16_t x_lag_number = 1071;

/// Largest distance of a load from its point at a shot, in steps over all axes.
std::int32_t worst_error(const Rig& rig, const job::Job& job) {
  std::int32_t worst = 0;
  for (std::size_t i = 0; i < rig.shots().size(); ++i)
    for (std::size_t a = 0; a < job.header.axes; ++a)
      worst = std::max(worst, std::abs(rig.shots()[i].steps[a] - job.targets[i].steps[a]));
  return worst;
}

struct Machine {
  double hz;
  LampMode mode;
  double accel_m_s2;
};
constexpr Machine machines[] = {{100, LampMode::slave, 2},
                                {1000, LampMode::slave, 10},
                                {2000, LampMode::slave, 10},
                                {200, LampMode::master, 4},
                                {300, LampMode::free_beat, 4}};

TEST(DriveLag, LoadsAreAtTheirPointAtEveryShot) {
  std::uint64_t seed = 1;
  for (const Machine& machine : machines)
    for (const JoinMode mode : all_modes) {
      SCOPED_TRACE(testing::Message() << machine.hz << " Hz, mode " << static_cast<int>(mode));
      job::Profile profile = lamp_profile(machine.hz, machine.mode, machine.accel_m_s2);
      set_lag(profile, {0, 150, 900});
      const job::Job job = job_for(histogram_walk(120, ++seed), profile, mode);
      Rig rig(profile);
      link::JobResult result;
      ASSERT_NO_FATAL_FAILURE(run_to_the_end(rig, job, false, result));
      EXPECT_EQ(worst_error(rig, job), 0);
      EXPECT_EQ(rig.board.controller().runner().misses(), 0u);
    }
}

TEST(DriveLag, WithoutASettingLoadsLagByTheirSpeedTimesTheLag) {
  for (const JoinMode mode : {JoinMode::free, JoinMode::path}) {
    const job::Profile profile = lamp_profile(1000, LampMode::slave, 10);
    sim::WorldConfig world = world_for(profile);
    constexpr double lag_s = 900e-6;
    world.drives.lag_us = {0, 0, lag_s * 1e6, 0};
    geometry::PointCloud row;
    for (int i = 0; i < 200; ++i) row.push_back({0, 0, 0.1 * i - 10});
    const job::Job job = job_for(row, profile, mode);
    Rig rig(profile.settings, world);
    ASSERT_EQ(run_job(rig, job).end, JobEnd::done);
    ASSERT_EQ(rig.shots().size(), row.size());
    double late = 0, expected = 0;
    for (std::size_t i = 1; i < row.size(); ++i) {
      const sim::Shot& shot = rig.shots()[i];
      EXPECT_EQ(shot.steps[0], job.targets[i].steps[0]);
      EXPECT_EQ(shot.steps[1], job.targets[i].steps[1]);
      late = std::max<double>(late, job.targets[i].steps[2] - shot.steps[2]);
      const double way = job.targets[i].steps[2] - job.targets[i - 1].steps[2];
      expected = std::max(expected, way / sim::seconds(shot.at - rig.shots()[i - 1].at) * lag_s);
    }
    EXPECT_GT(expected, 5);
    EXPECT_NEAR(late, expected, 2);
  }
}

TEST(DriveLag, RandomLagsUpToTheLongest) {
  for (int i = 0; i < scaled(20); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i));
    const Pick<double> up_to(random);
    const Machine& machine = machines[static_cast<std::size_t>(i) % std::size(machines)];
    job::Profile profile = lamp_profile(machine.hz, machine.mode, machine.accel_m_s2);
    const double max_us = i % 4 == 0 ? 5000 : i % 4 == 1 ? 30 : 1000;
    set_lag(profile, {i % 3 == 0 ? max_us : up_to(max_us), std::floor(up_to(max_us)), 0});
    if (i % 7 == 6) set_lag(profile, {5000, 5000, 5000});
    sim::LampConfig lamp;
    lamp.seed = static_cast<std::uint64_t>(i) + 1;
    lamp.phase_us = up_to(10'000);
    const bool faults = machine.mode == LampMode::slave && i % 2 == 1;
    if (faults) {
      lamp.jitter_us = 20;
      lamp.wander = max_us < 100 ? 0.01 : 0;  // a lag is turned into ticks at rest
      lamp.dropout = 0.02;
      lamp.runt = 0.1;
      lamp.doubled = 0.05;
    }
    const auto seed = static_cast<std::uint64_t>(i);
    const job::Job job = job_for(i % 5 == 0 ? wild_points(20, seed) : histogram_walk(80, seed),
                                 profile, all_modes[i % 3]);
    SCOPED_TRACE(testing::Message() << "seed " << i << ", " << machine.hz << " Hz");
    Rig rig(profile, lamp);
    link::JobResult result;
    ASSERT_NO_FATAL_FAILURE(run_to_the_end(rig, job, faults, result));
    EXPECT_EQ(result.status.starvations, 0u);
  }
}

TEST(DriveLag, ALampOffItsNominalFrequencyMakesTheTicksLongerNotTheLag) {
  for (const double off : {0.975, 1.025}) {
    job::Profile profile = lamp_profile(1000, LampMode::slave, 10);
    set_lag(profile, {5000, 0, 2500});
    geometry::PointCloud row;
    for (int i = 0; i < 200; ++i) row.push_back({0.1 * i - 10, 0.1 * i - 10, 10 - 0.1 * i});
    const job::Job job = job_for(row, profile, JoinMode::free);
    sim::WorldConfig world = world_for(profile);
    world.lamp.frequency_hz *= off;
    Rig rig(profile.settings, world);
    ASSERT_EQ(run_job(rig, job).end, JobEnd::done);
    // An error of 2.5 % of 5 ms at some ten steps per millisecond would exceed a step.
    EXPECT_EQ(worst_error(rig, job), 0) << off;
    ASSERT_NO_FATAL_FAILURE(expect_each_once(rig, job, false));
  }
}

TEST(DriveLag, MoreThanTheMaximumIsRefusedByItsNumber) {
  settings::Values values;
  EXPECT_TRUE(values.set_milli(Id::drive_lag_x, 5'000'000));
  EXPECT_FALSE(values.set_milli(Id::drive_lag_x, 5'000'001));
  EXPECT_FALSE(values.set_milli(Id::drive_lag_x, -1));
  EXPECT_EQ(settings::find_number(x_lag_number), Id::drive_lag_x);
  job::Profile profile = lamp_profile();
  set_lag(profile, {5000});
  job::Job job = job_for(histogram_walk(3, 1), profile, JoinMode::free);
  for (wire::Override& item : job.header.overrides)
    if (item.number == x_lag_number) item.value_milli = 5'000'001;
  Rig rig(profile);
  EXPECT_THAT(refusal(rig, job), HasSubstr("$1071"));
}

}  // namespace
}  // namespace lamplock::test::drive_lag_test
