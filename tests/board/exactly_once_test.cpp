// Every point exactly once, at its place, in order, inside the limits: over lamps, faults, modes.
#include "tests/board/rig.hpp"

namespace lamplock::test::exactly_once_test {
namespace {

struct Case {
  const char* name;
  double hz;
  LampMode mode;
  sim::LampConfig lamp;
  int points;
  friend void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }
};

class ExactlyOnce : public testing::TestWithParam<std::tuple<Case, JoinMode>> {};

TEST_P(ExactlyOnce, EveryPointInsideTheLimits) {
  const auto& [c, mode] = GetParam();
  // The beat clock lags a wandering lamp by a few microseconds.
  const bool jitter = c.lamp.jitter_us != 0 || c.lamp.wander != 0;
  for (int seed = 0; seed < scaled(1) + 1; ++seed) {
    const auto number = static_cast<std::uint64_t>(seed);
    sim::LampConfig lamp = c.lamp;
    lamp.seed = number + 1;
    lamp.phase_us = 1234.5 * seed / 10;
    const job::Profile profile = lamp_profile(c.hz, c.mode);
    const auto count = static_cast<std::size_t>(c.points);
    const job::Job job =
        job_for(seed % 2 == 0 ? histogram_walk(count, number) : wild_points(count / 4, number),
                profile, mode);
    Rig rig(profile, lamp);
    link::JobResult result;
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    ASSERT_NO_FATAL_FAILURE(run_to_the_end(rig, job, jitter, result));
    EXPECT_EQ(result.status.starvations, 0u);
    EXPECT_EQ(rig.board.controller().clock().lock_losses(), 0u);
    const auto outside = beats_of(result.status, BeatReason::outside_tolerance);
    // Without jitter every edge is in its place.
    if (!jitter) {
      EXPECT_EQ(outside, 0u);
    }
    if (c.lamp.dropout == 0 && !jitter) {
      EXPECT_EQ(rig.board.controller().runner().misses(), 0u);
    }
  }
}

const sim::LampConfig steady{};
const sim::LampConfig wandering{.jitter_us = 20, .wander = 0.01};
const sim::LampConfig everything{
    .jitter_us = 20, .wander = 0.01, .dropout = 0.02, .runt = 0.1, .doubled = 0.05};

INSTANTIATE_TEST_SUITE_P(
    Lamps, ExactlyOnce,
    testing::Combine(
        testing::Values(Case{"slave20", 20, LampMode::slave, steady, 250},
                        Case{"slave50", 50, LampMode::slave, steady, 250},
                        Case{"slave100", 100, LampMode::slave, steady, 500},
                        Case{"slave200", 200, LampMode::slave, steady, 500},
                        Case{"slave1000", 1000, LampMode::slave, steady, 250},
                        Case{"slave4000", 4000, LampMode::slave, steady, 100},
                        Case{"jitter20", 20, LampMode::slave, wandering, 250},
                        Case{"jitter50", 50, LampMode::slave, wandering, 600},
                        Case{"jitter100", 100, LampMode::slave, wandering, 500},
                        Case{"jitter200", 200, LampMode::slave, wandering, 500},
                        Case{"jitter1000", 1000, LampMode::slave, wandering, 250},
                        Case{"wander100", 100, LampMode::slave, {.wander = 0.01}, 600},
                        Case{"master50", 50, LampMode::master, steady, 250},
                        Case{"master100", 100, LampMode::master, steady, 500},
                        Case{"master1000", 1000, LampMode::master, steady, 250},
                        Case{"master4000", 4000, LampMode::master, steady, 100},
                        Case{"free100", 100, LampMode::free_beat, steady, 500},
                        Case{"free1000", 1000, LampMode::free_beat, steady, 250},
                        Case{"free4000", 4000, LampMode::free_beat, steady, 100},
                        Case{"dropouts", 100, LampMode::slave, {.dropout = 0.02}, 500},
                        Case{"dropoutsAsMaster", 100, LampMode::master, {.dropout = 0.02}, 500},
                        Case{"dropouts4000", 4000, LampMode::slave, {.dropout = 0.02}, 100},
                        Case{"runts", 100, LampMode::slave, {.runt = 0.1}, 500},
                        Case{"runts1000", 1000, LampMode::slave, {.runt = 0.1}, 250},
                        Case{"doubled", 100, LampMode::slave, {.doubled = 0.05}, 500},
                        Case{"doubled1000", 1000, LampMode::slave, {.doubled = 0.05}, 250},
                        Case{"everything50", 50, LampMode::slave, everything, 600},
                        Case{"everything100", 100, LampMode::slave, everything, 500},
                        Case{"everything200", 200, LampMode::slave, everything, 500},
                        Case{"everything1000", 1000, LampMode::slave, everything, 250}),
        testing::ValuesIn(both_modes)),
    [](const auto& tested) {
      return std::string(std::get<0>(tested.param).name) +
             (std::get<1>(tested.param) == JoinMode::free ? "Free" : "StartStop");
    });

/// Rows with a shot on every beat and a delay of most of a beat: where a flash fails, the next one
/// comes before the lattice tick of its shot.
TEST(ShotDelay, OfMostOfABeatNeverFiresAtTheNextPoint) {
  for (const double delay_us : {100.0, 160.0, 195.0, 210.0, 225.0}) {
    for (int seed = 0; seed < scaled(2) + 1; ++seed) {
      job::Profile profile = lamp_profile(4000, LampMode::slave, 10);
      job::state_setting(profile, Id::q_switch_delay, delay_us, "test");
      job::state_setting(profile, Id::q_switch_width, 20, "test");
      geometry::PointCloud row;
      for (int i = 0; i < 300; ++i) row.push_back({0.01 * i, 0, 0});
      const job::Job job = job::make_job(row, profile, {});
      Rig rig(profile, {.dropout = 0.05, .seed = static_cast<std::uint64_t>(seed) + 1});
      SCOPED_TRACE(testing::Message() << delay_us << " us, seed " << seed);
      const link::JobResult result = run_job(rig, job);
      ASSERT_EQ(result.end, link::JobEnd::done);
      ASSERT_NO_FATAL_FAILURE(expect_each_once(rig, job, false));
      EXPECT_GT(beats_of(result.status, BeatReason::no_edge), 0u);
    }
  }
}

/// Coarse steps: the tolerance is half a step, without a margin for rounding.
TEST(ShotTolerance, HoldsAtTheRealEdgeWithoutRoomToSpare) {
  for (const auto& [per_mm, tolerance_um] :
       {std::pair{50.0, 0.0}, {200.0, 12.5}, {200.0, 2.5}, {1000.0, 5.5}}) {
    job::Profile profile = lamp_profile(200, LampMode::slave, 10);
    for (int axis = 0; axis < 3; ++axis)
      job::state_setting(profile, settings::for_axis(Id::steps_per_mm_x, axis), per_mm, "test");
    job::set_speed(profile, 0.5);
    job::state_setting(profile, Id::shot_tolerance, tolerance_um, "test");
    const job::Job job =
        job::make_job(wild_points(static_cast<std::size_t>(scaled(100)), 5), profile, {});
    Rig rig(profile, {.jitter_us = 30, .wander = 0.01, .seed = 3});
    link::JobResult result;
    SCOPED_TRACE(testing::Message() << per_mm << " steps/mm, " << tolerance_um << " um");
    ASSERT_NO_FATAL_FAILURE(run_to_the_end(rig, job, true, result));
  }
}

/// Edges far off at speed must be refused and their beats reported as missed.
TEST(ShotTolerance, EdgesOutsideAreMissedBeats) {
  job::Profile profile = lamp_profile(200, LampMode::slave, 10);
  job::state_setting(profile, Id::lamp_jitter, 300, "test");
  const job::Job job = job::make_job(histogram_walk(600, 2), profile, {});
  Rig rig(profile, {.jitter_us = 300, .seed = 4});
  link::JobResult result;
  ASSERT_NO_FATAL_FAILURE(run_to_the_end(rig, job, true, result));
  EXPECT_GT(beats_of(result.status, BeatReason::outside_tolerance), 10u);
  EXPECT_GT(beats_of(result.status, BeatReason::returning), 10u);
}

TEST(ExactlyOnceCount, RuntsAreNotBeats) {
  // Ten runts per hundred periods must not be counted, not even as stray edges.
  const job::Profile profile = lamp_profile();
  const job::Job job = job::make_job(histogram_walk(400, 7), profile, {});
  Rig plain(profile), runts(profile, {.runt = 0.5, .seed = 9});
  ASSERT_EQ(run_job(plain, job).end, JobEnd::done);
  ASSERT_EQ(run_job(runts, job).end, JobEnd::done);
  EXPECT_EQ(runts.board.controller().clock().spurious(), 0u);
  EXPECT_EQ(runts.board.controller().clock().edges(), plain.board.controller().clock().edges());
  EXPECT_EQ(runts.shots(), plain.shots());
}

}  // namespace
}  // namespace lamplock::test::exactly_once_test
