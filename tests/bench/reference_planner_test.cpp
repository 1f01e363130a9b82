// The exact reference planner against exhaustive search, and its two searches against each other.
#include "host/bench/reference_planner.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/scale.hpp"

namespace lamplock::bench {
namespace {

/// Fewest beats among all combinations of at most `most` beats per segment.
class BruteForce {
 public:
  BruteForce(const ReferenceProblem& problem, int most) : problem_(problem), most_(most) {}

  long fewest() {
    best_ = start_stop_beats(problem_);
    try_all(0, 0, SpeedBox{});
    return best_;
  }

 private:
  void try_all(std::size_t i, int beats, const SpeedBox& from) {
    if (i == problem_.way.size()) {
      const bool rest = std::all_of(from.begin(), from.begin() + axes(),
                                    [](const SpeedRange& v) { return v.lo <= 0 && v.hi >= 0; });
      if (rest) best_ = std::min(best_, static_cast<long>(beats));
      return;
    }
    for (int k = 1; k <= most_; ++k) {
      SpeedBox to;
      bool any = true;
      for (std::size_t a = 0; a < problem_.axes && any; ++a)
        any = reach(from[a], problem_.way[i][a], k, problem_.limit[a], to[a]);
      if (any) try_all(i + 1, beats + k, to);
    }
  }
  std::ptrdiff_t axes() const { return static_cast<std::ptrdiff_t>(problem_.axes); }

  const ReferenceProblem& problem_;
  int most_;
  long best_ = 0;
};

/// Moves up to `longest` beats^2 on some axes, directions uniform or correlated.
ReferenceProblem random_problem(std::mt19937_64& random, std::size_t points, double longest) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> normal;
  ReferenceProblem problem;
  problem.axes = 1 + random() % 3;
  for (double& limit : problem.limit) limit = std::pow(100, unit(random)) / 2;
  const double turning = random() % 2 == 0 ? 1 : 0.15;
  std::array<double, max_axes> direction{};
  for (std::size_t i = 0; i < points; ++i) {
    double square = 0;
    for (std::size_t a = 0; a < problem.axes; ++a) {
      direction[a] = (1 - turning) * direction[a] + turning * normal(random);
      square += direction[a] * direction[a];
    }
    const double length = longest * std::pow(1e-3, unit(random));
    std::array<double, max_axes> way{};
    for (std::size_t a = 0; a < problem.axes; ++a)
      way[a] = direction[a] * length / std::sqrt(square);
    problem.way.push_back(way);
  }
  return problem;
}

TEST(ReferencePlanner, EqualsExhaustiveSearch) {
  std::mt19937_64 random(51);
  long optimum = 0, start_stop = 0;
  for (int i = 0; i < test::scaled(1'000); ++i) {
    const std::size_t points = 2 + random() % 3;
    const ReferenceProblem problem = random_problem(random, points, points == 4 ? 4 : 12);
    int most = 1;
    for (std::size_t k = 0; k < points; ++k) most = std::max(most, rest_to_rest(problem, k) + 3);
    const long best = BruteForce(problem, most).fewest();
    ASSERT_EQ(fewest_beats_of_sequence(problem).beats, best) << "sequence " << i;
    ASSERT_EQ(fewest_beats_of_stream(problem).beats, best) << "sequence " << i;
    optimum += best;
    start_stop += start_stop_beats(problem);
  }
  EXPECT_LT(optimum, start_stop);
}

TEST(ReferencePlanner, BothSearchesAgree) {
  // Too many points for exhaustive search; the two searches drop labels for different reasons.
  std::mt19937_64 random(52);
  for (int i = 0; i < test::scaled(600); ++i) {
    const std::size_t points = 10 + random() % 25;
    const ReferenceProblem problem = random_problem(random, points, i % 3 == 0 ? 30 : 3);
    ASSERT_EQ(fewest_beats_of_sequence(problem).beats, fewest_beats_of_stream(problem).beats)
        << "sequence " << i << " of " << points << " points";
  }
}

TEST(ReferencePlanner, BothSearchesAgreeOnASingleSolution) {
  // Regular rows: every bound is met exactly, and rounding must not remove the solution.
  std::mt19937_64 random(54);
  for (int i = 0; i < test::scaled(300); ++i) {
    ReferenceProblem problem;
    problem.axes = 1 + random() % 2;
    problem.limit.fill(static_cast<double>(1 + random() % 6));
    for (std::size_t run = 0; run < 4; ++run) {
      std::array<double, max_axes> way{};
      for (std::size_t a = 0; a < problem.axes; ++a)
        way[a] = (static_cast<double>(random() % 17) - 8) / 4;
      problem.way.insert(problem.way.end(), 1 + random() % 6, way);
    }
    ASSERT_EQ(fewest_beats_of_sequence(problem).beats, fewest_beats_of_stream(problem).beats)
        << "sequence " << i;
  }
}

TEST(ReferencePlanner, TimeCanBeReversed) {
  std::mt19937_64 random(53);
  for (int i = 0; i < test::scaled(300); ++i) {
    const ReferenceProblem problem = random_problem(random, 12, 10);
    ReferenceProblem back = problem;
    std::reverse(back.way.begin(), back.way.end());
    ASSERT_EQ(fewest_beats(problem).beats, fewest_beats(back).beats) << "sequence " << i;
  }
}

TEST(ReferencePlanner, KnowsClosedForms) {
  // One step takes 2 sqrt(d/A); a regular row takes one beat per point, except at its ends.
  ReferenceProblem step;
  step.limit.fill(1000);
  step.way = {{100}};
  EXPECT_EQ(fewest_beats(step).beats, 20);
  step.way = {{100.1}};
  EXPECT_EQ(fewest_beats(step).beats, 21);
  ReferenceProblem row;
  row.limit.fill(20);
  row.way.assign(1000, {1, 0, 0, 0});
  const ReferenceResult best = fewest_beats(row);
  EXPECT_EQ(start_stop_beats(row), 2000);
  EXPECT_GE(best.beats, 1001);
  EXPECT_LE(best.beats, 1004);
  EXPECT_GE(best.labels, 1000u);
}

}  // namespace
}  // namespace lamplock::bench
