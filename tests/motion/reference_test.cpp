// The fixed-point planner compared with the exact optimum.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <random>

#include "host/bench/glass_tables.hpp"
#include "host/bench/reference_planner.hpp"
#include "host/bench/walks.hpp"
#include "tests/motion/chain.hpp"
#include "tests/scale.hpp"

namespace lamplock::motion::reference_test {
namespace {

using test::Chain;

/// A machine and the distribution of its points.
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
    wire::Target t;
    for (std::size_t a = 0; a < static_cast<std::size_t>(walk.axes); ++a) {
      at[a] += length_um * 1e-3 * direction[a] / std::sqrt(norm);
      t.steps[a] = static_cast<std::int32_t>(std::lround(at[a] * steps_per_mm));
    }
    chain.targets.push_back(t);
  }
  return chain;
}

const std::vector<Walk> walks{
    {100, 2, 0.1, 2}, {100, 4, 0.1, 2}, {100, 10, 0.1, 3}, {200, 10, 1, 2}};

/// Ten points: lengths over three decades, directions uniform or correlated, 2-D and 3-D, lamps
/// between two frequencies, machines of all kinds, unlimited work space.
Chain random_sequence(double min_hz, double max_hz, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> normal;
  const auto log_uniform = [&](double lo, double hi) {
    return lo * std::pow(hi / lo, unit(random));
  };
  const double lamp_hz = log_uniform(min_hz, max_hz), accel_m_s2 = log_uniform(1, 30);
  const double steps_per_mm = log_uniform(200, 800);
  const double speed_m_s = std::min(log_uniform(0.05, 1), 900 / steps_per_mm);
  const auto axes = static_cast<std::size_t>(2 + random() % 2);
  Chain chain;
  chain.limits = test::limits_of(
      test::machine_settings(lamp_hz, accel_m_s2, speed_m_s, static_cast<int>(axes), steps_per_mm));
  const double turning = random() % 2 == 0 ? 1.0 : 0.15;
  std::array<double, max_axes> at{}, direction{};
  for (int i = 0; i < 10; ++i) {
    const double length = log_uniform(0.005, 5) * steps_per_mm;
    double norm = 0;
    for (std::size_t a = 0; a < axes; ++a) {
      direction[a] = (1 - turning) * direction[a] + turning * normal(random);
      norm += direction[a] * direction[a];
    }
    wire::Target target;
    for (std::size_t a = 0; a < axes; ++a) {
      direction[a] /= std::sqrt(norm);
      at[a] += length * direction[a];
      target.steps[a] = static_cast<std::int32_t>(std::lround(at[a]));
    }
    chain.targets.push_back(target);
  }
  for (AxisLimits& axis : chain.limits.axis) {
    axis.min_steps = -2'000'000'000;
    axis.max_steps = 2'000'000'000;
  }
  return chain;
}

/// Difference from the exact optimum over many sequences.
struct Grade {
  long optimum = 0, planned = 0, start_stop = 0;
  int sequences = 0, longer = 0;
  long max_more = 0;            ///< largest excess of a sequence, in beats
  int beyond_tenth_or_two = 0;  ///< sequences more than the larger of 10 % and 2 beats longer

  double gap_percent() const {
    return 100 * static_cast<double>(planned - optimum) / static_cast<double>(optimum);
  }
};

Grade grade(double min_hz, double max_hz, int sequences, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto planner = std::make_unique<Planner>();
  Grade grade;
  for (; grade.sequences < sequences; ++grade.sequences) {
    const Chain chain = random_sequence(min_hz, max_hz, random);
    const bench::ReferenceProblem problem = bench::problem_of(chain.limits, chain.targets);
    const long best = bench::fewest_beats(problem).beats;
    const test::ChainPlan plan = test::plan_chain(chain, *planner);
    EXPECT_EQ(plan.result, Result::ok);
    const long more = plan.total_beats() - best;
    EXPECT_GE(more, 0) << "better than the optimum: sequence " << grade.sequences;
    grade.optimum += best;
    grade.planned += plan.total_beats();
    grade.start_stop += bench::start_stop_beats(problem);
    grade.longer += more > 0 ? 1 : 0;
    grade.max_more = std::max(grade.max_more, more);
    grade.beyond_tenth_or_two += more > 2 && 10 * more > best ? 1 : 0;
  }
  std::cout << min_hz << " to " << max_hz << " Hz, " << sequences
            << " sequences of 10 points: optimum " << grade.optimum << " beats, planner "
            << grade.planned << " (+" << grade.gap_percent() << " %, " << grade.longer
            << " sequences longer, none by more than " << grade.max_more << ", "
            << grade.beyond_tenth_or_two << " by more than a tenth and two), start-stop "
            << grade.start_stop << "\n";
  testing::Test::RecordProperty("gap_percent", std::to_string(grade.gap_percent()));
  return grade;
}

TEST(Planner, NeedsNoMoreBeatsThanTheExactOptimumAtLampsOf50To200Hz) {
  const Grade result = grade(50, 200, std::max(1'000, test::scaled(1'000)), 52);
  EXPECT_LE(result.gap_percent(), 0.05);
  EXPECT_LE(result.max_more, 1);
  EXPECT_LT(result.optimum, result.start_stop);
}

TEST(Planner, IsCloseToTheExactOptimumAtLampsOfKilohertz) {
  // With other seeds the exact search takes minutes for single sequences.
  for (const std::uint64_t seed : {53u, 56u, 57u, 59u}) {
    SCOPED_TRACE(seed);
    const Grade result = grade(500, 5000, test::scaled(125), seed);
    EXPECT_LE(result.gap_percent(), 2);
    EXPECT_EQ(result.beyond_tenth_or_two, 0);
    EXPECT_LT(result.optimum, result.start_stop);
  }
}

TEST(Planner, TakesMoreBeatsIfRoundingMakesAProfileImpossible) {
  // Long moves next to short ones, V/A of 0.1 s and more: the profile of one move of this sequence
  // needs slightly more than the available acceleration.
  constexpr int spoilt = 3622;
  std::mt19937_64 random(58);
  for (int i = 0; i < spoilt; ++i) random_sequence(500, 5000, random);
  const Chain chain = random_sequence(500, 5000, random);
  const auto planner = std::make_unique<Planner>();
  const test::ChainPlan plan = test::plan_chain(chain, *planner);
  ASSERT_EQ(plan.result, Result::ok);
  const long best = bench::fewest_beats(bench::problem_of(chain.limits, chain.targets)).beats;
  EXPECT_LE(plan.total_beats(), best + best / 10);
}

TEST(Planner, EqualsTheOptimumOverLongStreams) {
  // Windows, most of them committed at once, compared with an optimum over the whole stream.
  std::mt19937_64 random(53);
  Planner planner;
  long optimum = 0, planned = 0;
  // A single beat is a tenth of a percent of twenty streams.
  for (int i = 0; i < std::max(200, test::scaled(200)); ++i) {
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
  EXPECT_LE(gap, 0.1);
}

}  // namespace
}  // namespace lamplock::motion::reference_test
