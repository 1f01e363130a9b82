#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "host/error.hpp"
#include "host/report/matching.hpp"
#include "host/report/report.hpp"
#include "tests/report/job_run.hpp"
#include "tests/scale.hpp"

namespace lamplock::report {
namespace {

using test::add_shot;
using test::add_shot_at_point;
using test::job;
using test::perfect_run;
using test::rounded_steps;

TEST(Evaluate, PerfectRun) {
  JobRun run = perfect_run(5000, 1);
  run.beats = 6250;
  run.time_s = 62.5;
  const Report report = evaluate(run);
  EXPECT_EQ(report.points, 5000u);
  EXPECT_EQ(report.shots, 5000u);
  EXPECT_EQ(report.missed, 0u);
  EXPECT_EQ(report.doubled, 0u);
  EXPECT_DOUBLE_EQ(report.utilisation, 0.8);
  EXPECT_DOUBLE_EQ(report.beats_per_point, 1.25);
  EXPECT_DOUBLE_EQ(report.points_per_s, 80);
  EXPECT_DOUBLE_EQ(report.lamp_hz, 100);
  ASSERT_TRUE(report.max_error_steps);
  EXPECT_LE(*report.max_error_steps, 0.5);
  EXPECT_GT(*report.max_error_steps,
            0.45);  // with this many points rounding comes close to 0.5
}

/// Random faults of every kind; exactly these must be found.
TEST(Evaluate, FindsEveryMissedAndDoubledPoint) {
  constexpr std::size_t old_point = 250;  // fired in order, and sometimes again much later
  for (int seed = 0; seed < lamplock::test::scaled(30); ++seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    JobRun run = job(2000, static_cast<std::uint64_t>(seed));
    std::uint64_t missed = 0, doubled = 0;
    std::vector<std::size_t> later;
    for (std::size_t i = 0; i < run.points.size(); ++i) {
      const auto fault = i == old_point ? 100 : random() % 20;
      if (fault == 0) {
        ++missed;
      } else if (fault == 1) {
        later.push_back(i);
      } else {
        add_shot_at_point(run, i);
      }
      if (fault == 2 || (fault == 3 && i > old_point)) {
        add_shot_at_point(run, fault == 2 ? i : old_point);
        ++doubled;
      }
      if (!later.empty() && random() % 3 == 0) {
        add_shot_at_point(run, later.front());
        later.erase(later.begin());
      }
    }
    for (std::size_t i : later) add_shot_at_point(run, i);
    const Report report = evaluate(run);
    EXPECT_GT(missed, 50u);
    EXPECT_GT(doubled, 100u);
    EXPECT_EQ(report.missed, missed) << seed;
    EXPECT_EQ(report.doubled, doubled) << seed;
    EXPECT_LE(*report.max_error_steps, 0.5) << seed;
  }
}

TEST(Evaluate, AssignsEveryShotOfAShuffledJob) {
  JobRun run = job(3000, 4);
  std::vector<std::size_t> order(run.points.size());
  std::iota(order.begin(), order.end(), 0u);
  std::mt19937_64 random(3);
  std::shuffle(order.begin(), order.end(), random);
  for (std::size_t i : order) add_shot_at_point(run, i);
  const Matching matching = match_shots(run);
  for (std::size_t i = 0; i < order.size(); ++i)
    ASSERT_EQ(matching.point_of_shot[i], order[i]) << i;
  EXPECT_EQ(matching.missed + matching.doubled, 0u);
}

TEST(Evaluate, AShotAtAWrongPlaceIsAnErrorNotAMiss) {
  JobRun run = perfect_run(1000, 2);
  run.lattice_steps[400][1] += 9;
  run.shots[400].steps[1] += 9;
  const Report report = evaluate(run);
  EXPECT_EQ(report.missed, 0u);
  EXPECT_EQ(report.doubled, 0u);
  EXPECT_NEAR(*report.max_error_steps, 9, 0.5);
}

TEST(Evaluate, ADistantStrayShotIsReported) {
  JobRun run = job(500, 2);
  for (std::size_t i = 0; i < run.points.size(); ++i) {
    if (i == 250) add_shot(run, {5000, 5000, 5000, 0});
    add_shot_at_point(run, i);
  }
  const Report report = evaluate(run);
  EXPECT_EQ(report.missed, 0u);
  EXPECT_EQ(report.doubled, 1u);
  EXPECT_GT(*report.max_error_steps, 3000);
}

TEST(Evaluate, JitterIsReportedSeparately) {
  JobRun run = perfect_run(1000, 3);
  run.shots[10].steps[0] += 1;
  run.shots[77].steps[2] -= 2;
  const Report report = evaluate(run);
  EXPECT_LE(*report.max_error_steps, 0.5);
  EXPECT_NEAR(*report.max_jitter_error_steps, 2, 0.5);
  run.lattice_steps.clear();
  const Report unknown = evaluate(run);
  EXPECT_FALSE(unknown.max_error_steps);
  EXPECT_EQ(unknown.missed, 0u);
  EXPECT_EQ(unknown.doubled, 0u);
  EXPECT_EQ(unknown.max_jitter_error_steps, report.max_jitter_error_steps);
}

TEST(Evaluate, EqualPointsAreEachFiredOnce) {
  JobRun run;
  run.points = {{1, 2, 3}, {1, 2, 3}, {1.001, 2, 3}, {1, 2, 3}};
  for (std::size_t i = 0; i < 4; ++i) add_shot_at_point(run, i);
  EXPECT_EQ(evaluate(run).missed, 0u);
  EXPECT_EQ(evaluate(run).doubled, 0u);
  add_shot_at_point(run, 0);
  EXPECT_EQ(evaluate(run).doubled, 1u);
}

TEST(Evaluate, ALateShotAtEqualPointsIsAssignedToTheUnfiredOne) {
  JobRun run;
  run.points = {{1, 2, 3}, {5, 2, 3}, {1, 2, 3}, {9, 2, 3}};
  for (std::size_t i : {3u, 0u, 2u, 1u}) add_shot_at_point(run, i);
  EXPECT_EQ(evaluate(run).missed, 0u);
  EXPECT_EQ(evaluate(run).doubled, 0u);
}

TEST(Evaluate, SeveralShotsPerPoint) {
  JobRun run = job(10, 1);
  run.shots_ordered.assign(10, 2);
  run.shots_ordered[3] = 0;
  for (std::size_t i = 0; i < 10; ++i)
    for (int n = 0; n < run.shots_ordered[i]; ++n) add_shot_at_point(run, i);
  EXPECT_EQ(evaluate(run).missed, 0u);
  EXPECT_EQ(evaluate(run).doubled, 0u);
  add_shot_at_point(run, 7);
  add_shot_at_point(run, 3);
  EXPECT_EQ(evaluate(run).doubled, 2u);
}

TEST(Evaluate, FewerShotsThanOrderedAreMissed) {
  JobRun run = job(10, 1);
  run.shots_ordered.assign(10, 3);
  for (std::size_t i = 0; i < 10; ++i)
    for (int n = 0; n < (i == 4 ? 2 : 3); ++n) add_shot_at_point(run, i);
  EXPECT_EQ(evaluate(run).missed, 1u);
  EXPECT_EQ(evaluate(run).doubled, 0u);
}

TEST(Evaluate, RepetitionsAfterMissedShotsAreNotDoubled) {
  JobRun run = job(50, 3);
  for (std::size_t i = 0; i < run.points.size(); ++i) {
    add_shot_at_point(run, i);
    if (i % 10 == 0) add_shot_at_point(run, i);
  }
  run.checks.repeats = 4;
  EXPECT_EQ(evaluate(run).doubled, 1u);
  run.checks.repeats = 5;
  EXPECT_EQ(evaluate(run).doubled, 0u);
  EXPECT_EQ(evaluate(run).missed, 0u);
}

TEST(Evaluate, NothingFiredOrNothingToFire) {
  JobRun run = job(100, 1);
  EXPECT_EQ(evaluate(run).missed, 100u);
  EXPECT_FALSE(evaluate(run).max_error_steps);
  EXPECT_EQ(evaluate(run).utilisation, 0);
  JobRun empty;
  add_shot(empty, {1, 2, 3, 0});
  EXPECT_EQ(evaluate(empty).doubled, 1u);
  EXPECT_EQ(evaluate(empty).missed, 0u);
}

TEST(Evaluate, UnknownShotsStayUnknown) {
  JobRun run = job(100, 1);
  run.shots_known = false;
  run.shots_fired = 99;
  const Report report = evaluate(run);
  EXPECT_EQ(report.shots, 99u);
  EXPECT_FALSE(report.missed || report.doubled || report.max_error_steps ||
               report.max_jitter_error_steps);
}

TEST(Evaluate, RefusesARunThatContradictsItself) {
  JobRun run = perfect_run(10, 1);
  run.lattice_steps.pop_back();
  EXPECT_THROW(evaluate(run), Error);
  run = perfect_run(10, 1);
  run.shots_ordered = {1, 2, 3};
  EXPECT_THROW(evaluate(run), Error);
}

TEST(Evaluate, OfAStoppedJobCountsTheFiredPoints) {
  for (int seed = 0; seed < lamplock::test::scaled(20); ++seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    const auto flashes = static_cast<std::uint16_t>(1 + random() % 3);
    const std::size_t fired = random() % 200;
    JobRun run = job(200, static_cast<std::uint64_t>(seed));
    run.shots_ordered.assign(200, flashes);
    for (std::size_t i = 0; i < fired; ++i)
      for (int n = 0; n < flashes; ++n) add_shot_at_point(run, i);
    // The point at which it was stopped has all flashes but one.
    for (int n = 1; n < flashes; ++n) add_shot_at_point(run, fired);
    run.beats = 2 * run.shots.size();
    run.time_s = static_cast<double>(run.beats) / 100;
    const Report report = evaluate(run);
    EXPECT_EQ(report.points, 200u);
    EXPECT_EQ(report.points_fired, fired) << seed;
    EXPECT_EQ(report.missed, 200 - fired) << seed;
    EXPECT_EQ(report.shots, run.shots.size());
    if (fired == 0) continue;
    EXPECT_DOUBLE_EQ(report.beats_per_point * static_cast<double>(fired),
                     static_cast<double>(run.beats));
    EXPECT_DOUBLE_EQ(report.points_per_s * run.time_s, static_cast<double>(fired));
  }
}

TEST(Evaluate, UnobservedShotsAreTakenFromTheMachine) {
  JobRun run = job(50, 1);
  run.shots_known = false;
  run.shots_fired = 30;
  run.points_fired = 30;
  run.beats = 60;
  const Report report = evaluate(run);
  EXPECT_EQ(report.points, 50u);
  EXPECT_EQ(report.points_fired, 30u);
  EXPECT_DOUBLE_EQ(report.beats_per_point, 2);
}

TEST(Evaluate, ADryRunFiresNoPoint) {
  JobRun run = job(50, 1);
  run.shots_ordered.assign(50, 0);
  EXPECT_EQ(evaluate(run).points_fired, 0u);
  EXPECT_EQ(evaluate(run).missed, 0u);
}

TEST(PointNumbers, CountPausesWithThePoints) {
  JobRun run = job(6, 1);
  run.first_number = 10;
  // Two in a row before the first point, one before the fourth, one after the last.
  run.pauses = {0, 0, 3, 6};
  EXPECT_EQ(point_numbers(run), (std::vector<std::uint64_t>{12, 13, 14, 16, 17, 18}));
}

/// A hold is the user's time: it says nothing about the job.
TEST(Evaluate, RatiosHaveNoHeldBeats) {
  JobRun run = test::perfect_run(100, 3);
  run.beats = 400;
  run.beats_by_reason = {{"fired", 100}, {"moving", 100}, {"hold", 150}, {"door", 50}};
  const Report report = evaluate(run);
  EXPECT_DOUBLE_EQ(report.beats_per_point, 2);
  EXPECT_DOUBLE_EQ(report.utilisation, 0.5);
  EXPECT_EQ(report.beats, 400u);
}

}  // namespace
}  // namespace lamplock::report
