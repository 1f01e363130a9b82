// The fixed-point planner graded by the exact optimum.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>

#include "host/bench/glass_tables.hpp"
#include "host/bench/reference_planner.hpp"
#include "host/bench/walks.hpp"
#include "tests/motion/chain.hpp"
#include "tests/scale.hpp"

namespace lamplock::motion {
namespace {

using test::Chain;

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
    for (const bench::StepLength& bin : bench::glass_step_lengths) {
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

const std::vector<Walk> walks{{100, 2, 0.1, 2}, {100, 4, 0.1, 2}, {100, 10, 0.1, 3},
                              {200, 10, 1, 2},  {50, 2, 0.1, 3},  {200, 30, 0.3, 1},
                              {150, 5, 0.2, 3}, {70, 3, 0.05, 2}};

TEST(Planner, NeedsHardlyMoreBeatsThanTheExactOptimum) {
  std::mt19937_64 random(52);
  Planner planner;
  long optimum = 0, planned = 0, start_stop = 0;
  int worse = 0, two_more = 0;
  const int sequences = test::scaled(500);
  for (int i = 0; i < sequences; ++i) {
    const Chain chain = random_walk(walks[static_cast<std::size_t>(i) % walks.size()], 10, random);
    const bench::ReferenceProblem problem = bench::problem_of(chain.limits, chain.targets);
    const long best = bench::fewest_beats(problem).beats;
    const test::ChainPlan plan = test::plan_chain(chain, planner);
    ASSERT_EQ(plan.result, Result::ok);
    ASSERT_GE(plan.total_beats(), best) << "better than the optimum: sequence " << i;
    EXPECT_LE(plan.total_beats(), best + 2) << "sequence " << i;
    two_more += plan.total_beats() > best + 1 ? 1 : 0;
    optimum += best;
    planned += plan.total_beats();
    worse += plan.total_beats() > best ? 1 : 0;
    start_stop += bench::start_stop_beats(problem);
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
    optimum += bench::fewest_beats(bench::problem_of(chain.limits, chain.targets)).beats;
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

}  // namespace
}  // namespace lamplock::motion
