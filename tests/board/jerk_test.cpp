// Jerk limits on the whole board: jobs, holds at any moment, refused values.

#include "tests/board/board_cable.hpp"

namespace lamplock::test {
namespace {

job::Profile jerk_profile(double jerk_m_s3, double hz = 100) {
  job::Profile profile = lamp_profile(hz);
  for (int axis = 0; axis < 3; ++axis)
    job::state_setting(profile, settings::for_axis(Id::jerk_x, axis), jerk_m_s3, "test");
  return profile;
}

constexpr JoinMode every_mode[] = {JoinMode::free, JoinMode::start_stop, JoinMode::path};

TEST(Jerk, JobsAreDoneInsideTheWorkSpace) {
  for (const double jerk : {30.0, 300.0, 3000.0})
    for (const JoinMode mode : every_mode) {
      SCOPED_TRACE(jerk);
      const job::Profile profile = jerk_profile(jerk);
      const job::Job job =
          job_for(wild_points(static_cast<std::size_t>(scaled(60)), 91), profile, mode);
      Rig rig(profile);
      EXPECT_EQ(run_job(rig, job).end, JobEnd::done);
      expect_each_once(rig, job, false);
      expect_sound(rig, profile.settings);
    }
}

TEST(Jerk, HoldsAtAnyMomentStopInsideAndResume) {
  for (std::uint64_t seed = 0; seed < static_cast<std::uint64_t>(scaled(12)); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937_64 random(seed + 900);
    const auto up_to = [&random](std::uint64_t ms) {
      return static_cast<Picoseconds>(random() % (ms * 1000)) * ps_per_us;
    };
    const job::Profile profile = jerk_profile(20.0 * std::pow(10.0, static_cast<double>(seed % 3)));
    const job::Job job = job_for(wild_points(30, seed + 92), profile, every_mode[seed % 4 % 3]);
    Rig rig(profile);
    BoardCable cable(rig);
    for (auto at = up_to(1000); at < 10'000 * ps_per_ms; at += up_to(500)) {
      cable.at(at, [&cable] { cable.type("!"); });
      cable.at(at += up_to(300), [&cable] { cable.type("~"); });
    }
    EXPECT_EQ(link::JobSender(cable, job, session(0x5EED)).run().end, JobEnd::done);
    ASSERT_NO_FATAL_FAILURE(expect_each_once(rig, job, false));
    expect_sound(rig, profile.settings);
  }
}

TEST(Jerk, LooserLimitsAreRefusedWithTheSetting) {
  const job::Profile profile = jerk_profile(100);
  const geometry::PointCloud points = wild_points(10, 1);
  for (const double asked : {0.0, 100.5}) {
    job::Profile looser = profile;
    job::state_setting(looser, Id::jerk_y, asked, "test");
    Rig rig(profile);
    EXPECT_THAT(refusal(rig, job::make_job(points, looser, {})), HasSubstr("$1082"));
  }
  // A machine without its own limit accepts any.
  Rig rig(lamp_profile());
  EXPECT_EQ(refusal(rig, job::make_job(points, profile, {})), "taken");
}

}  // namespace
}  // namespace lamplock::test
