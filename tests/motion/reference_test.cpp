// The fixed-point planner graded by the exact optimum, and start-stop by measured machine times.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>

#include "tests/data/glass_tables.hpp"
#include "tests/motion/chain.hpp"
#include "tests/motion/reference_planner.hpp"
#include "tests/scale.hpp"

namespace lamplock::motion {
namespace {

using test::Chain;
using test::ReferencePlanner;
using test::ReferenceProblem;

/// A machine and how its points are drawn.
struct Walk {
  double lamp_hz, accel_m_s2, speed_m_s;
  int axes;
};

Chain random_walk(const Walk& walk, std::size_t points, std::mt19937_64& random) {
  constexpr double steps_per_mm = 200;
  Chain chain;
  chain.limits = test::limits_of(test::machine_settings(walk.lamp_hz, walk.accel_m_s2,
                                                        walk.speed_m_s, walk.axes, steps_per_mm));
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> normal;
  std::array<double, max_axes> at{};
  for (std::size_t i = 0; i < points; ++i) {
    double draw = unit(random), length_um = 0;
    for (const test::StepLength& bin : test::glass_step_lengths) {
      length_um = bin.step_um;
      if ((draw -= bin.fraction) < 0) break;
    }
    std::array<double, max_axes> direction{};
    double norm = 0;
    for (std::size_t a = 0; a < static_cast<std::size_t>(walk.axes); ++a) {
      direction[a] = normal(random);
      norm += direction[a] * direction[a];
    }
    Target t;
    for (std::size_t a = 0; a < static_cast<std::size_t>(walk.axes); ++a) {
      at[a] += length_um * 1e-3 * direction[a] / std::sqrt(norm);
      t.steps[a] = static_cast<std::int32_t>(std::lround(at[a] * steps_per_mm));
    }
    chain.targets.push_back(t);
  }
  return chain;
}

/// The same sequence for the reference, with the true limits.
ReferenceProblem problem_of(const Chain& chain) {
  ReferenceProblem problem;
  problem.axes = static_cast<std::size_t>(chain.limits.axes);
  const double beat = chain.limits.beat_ticks;
  StepPosition from{};
  problem.way.resize(chain.targets.size());
  for (std::size_t a = 0; a < problem.axes; ++a) {
    const double accel = std::ldexp(static_cast<double>(chain.limits.axis[a].accel_q62), -62);
    const double speed = std::ldexp(static_cast<double>(chain.limits.axis[a].speed_q62), -62);
    problem.limit[a] = speed / (accel * beat);
    for (std::size_t i = 0; i < chain.targets.size(); ++i) {
      const std::int32_t before = i == 0 ? from[a] : chain.targets[i - 1].steps[a];
      problem.way[i][a] = (chain.targets[i].steps[a] - before) / (accel * beat * beat);
    }
  }
  return problem;
}

const std::vector<Walk> walks{{100, 2, 0.1, 2}, {100, 4, 0.1, 2}, {100, 10, 0.1, 3},
                              {200, 10, 1, 2},  {50, 2, 0.1, 3},  {200, 30, 0.3, 1},
                              {150, 5, 0.2, 3}, {70, 3, 0.05, 2}};

TEST(ReferencePlanner, FindsWhatTryingEverythingFinds) {
  std::mt19937_64 random(51);
  for (int i = 0; i < test::scaled(100); ++i) {
    const Walk& walk = walks[random() % walks.size()];
    ReferenceProblem problem = problem_of(random_walk(walk, 4, random));
    // Steps that take many beats make trying everything slow: shorten them.
    int most = 1;
    for (std::size_t k = 0; k < problem.way.size(); ++k) {
      for (double& way : problem.way[k]) way = std::clamp(way, -3.0, 3.0);
      most = std::max(most, ReferencePlanner::rest_to_rest(problem, k) + 2);
    }
    ASSERT_EQ(ReferencePlanner::fewest_beats(problem),
              ReferencePlanner::by_brute_force(problem, most))
        << "sequence " << i;
  }
}

TEST(Planner, NeedsHardlyMoreBeatsThanTheExactOptimum) {
  std::mt19937_64 random(52);
  Planner planner;
  long optimum = 0, planned = 0, start_stop = 0;
  int worse = 0, two_more = 0;
  const int sequences = test::scaled(500);
  for (int i = 0; i < sequences; ++i) {
    const Chain chain = random_walk(walks[static_cast<std::size_t>(i) % walks.size()], 10, random);
    const ReferenceProblem problem = problem_of(chain);
    const long best = ReferencePlanner::fewest_beats(problem);
    const test::ChainPlan plan = test::plan_chain(chain, planner);
    ASSERT_EQ(plan.result, Result::ok);
    ASSERT_GE(plan.total_beats(), best) << "better than the optimum: sequence " << i;
    EXPECT_LE(plan.total_beats(), best + 2) << "sequence " << i;
    two_more += plan.total_beats() > best + 1 ? 1 : 0;
    optimum += best;
    planned += plan.total_beats();
    worse += plan.total_beats() > best ? 1 : 0;
    for (std::size_t k = 0; k < problem.way.size(); ++k)
      start_stop += ReferencePlanner::rest_to_rest(problem, k);
  }
  const double gap = 100 * static_cast<double>(planned - optimum) / static_cast<double>(optimum);
  RecordProperty("gap_percent", std::to_string(gap));
  std::cout << sequences << " sequences of 10 points: optimum " << optimum << " beats, planner "
            << planned << " (+" << gap << " %, " << worse << " sequences longer), start-stop "
            << start_stop << "\n";
  EXPECT_LE(gap, 0.5);
  EXPECT_LE(two_more, sequences / 1000) << "sequences with two beats more";
  EXPECT_LT(optimum, start_stop);
}

TEST(Planner, StaysAtTheOptimumOverLongStreams) {
  // Windows, most of them committed at once, against an optimum that sees the whole stream.
  std::mt19937_64 random(53);
  Planner planner;
  long optimum = 0, planned = 0;
  for (int i = 0; i < test::scaled(200); ++i) {
    const Chain chain = random_walk(walks[static_cast<std::size_t>(i) % 4], 40, random);
    optimum += ReferencePlanner::fewest_beats(problem_of(chain));
    const test::ChainPlan plan = test::plan_chain(chain, planner);
    ASSERT_EQ(plan.result, Result::ok);
    planned += plan.total_beats();
  }
  const double gap = 100 * static_cast<double>(planned - optimum) / static_cast<double>(optimum);
  RecordProperty("stream_gap_percent", std::to_string(gap));
  std::cout << "streams of 40 points: optimum " << optimum << " beats, planner " << planned << " (+"
            << gap << " %)\n";
  EXPECT_GE(planned, optimum);
  EXPECT_LE(gap, 1.0);
}

/// Largest-remainder counts: whole numbers of the fractions that add up to `total`.
std::vector<int> counts_of(int total) {
  double sum = 0;
  for (const test::StepLength& bin : test::glass_step_lengths) sum += bin.fraction;
  std::vector<int> counts;
  std::vector<std::pair<double, std::size_t>> rest;
  int given = 0;
  for (std::size_t i = 0; i < test::glass_step_lengths.size(); ++i) {
    const double share = test::glass_step_lengths[i].fraction / sum * total;
    counts.push_back(static_cast<int>(share));
    given += counts.back();
    rest.emplace_back(-(share - counts.back()), i);
  }
  std::sort(rest.begin(), rest.end());
  for (std::size_t i = 0; given < total; ++i, ++given) ++counts[rest[i].second];
  return counts;
}

/// Beats from rest to rest over one step of the histogram on a machine of 1 um steps. A time that
/// is a whole number of beats to the last digit counts as reached: the step is taken 1 um shorter.
int beats_for(const test::StartStopTime& row, double step_um, Planner& planner) {
  const double way_m = step_um * 1e-6, a = row.accel_m_s2, v = row.speed_m_s;
  const double time_s = std::sqrt(way_m * a) <= v ? 2 * std::sqrt(way_m / a) : way_m / v + v / a;
  const double beats = time_s * row.lamp_hz;
  const bool tie = std::fabs(beats - std::round(beats)) < 1e-9;
  Chain chain;
  chain.mode = JoinMode::start_stop;
  chain.limits = test::limits_of(test::machine_settings(row.lamp_hz, a, v, 1, 1000));
  Target t;
  t.steps[0] = static_cast<std::int32_t>(step_um) - (tie ? 1 : 0);
  chain.targets = {t};
  return static_cast<int>(test::plan_chain(chain, planner).total_beats());
}

TEST(Planner, StartStopReproducesTheMeasuredTimes) {
  const std::vector<int> counts = counts_of(test::glass_points);
  Planner planner;
  double worst = 0;
  for (const test::StartStopTime& row : test::glass_start_stop_times) {
    long beats = 0;
    for (std::size_t i = 0; i < counts.size(); ++i)
      beats += counts[i] * beats_for(row, test::glass_step_lengths[i].step_um, planner);
    const double measured = row.lamp_hz * row.time_s / test::glass_points;
    const double error = static_cast<double>(beats) / test::glass_points / measured - 1;
    worst = std::max(worst, std::fabs(error));
    EXPECT_LT(std::fabs(error), 0.01)
        << row.lamp_hz << " Hz, " << row.accel_m_s2 << " m/s2, " << row.speed_m_s << " m/s";
  }
  RecordProperty("worst_error_percent", std::to_string(100 * worst));
  std::cout << "measured start-stop times: worst row " << 100 * worst << " %\n";
}

}  // namespace
}  // namespace lamplock::motion
