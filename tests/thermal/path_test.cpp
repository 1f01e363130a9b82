// The motion of a beam along moves, and the temperature along a path: turns, M3 against M4,
// balance.
#include <gtest/gtest.h>

#include <cmath>

#include "host/geometry/random.hpp"
#include "host/thermal/path_picture.hpp"
#include "host/thermal/path_run.hpp"
#include "tests/thermal/cases.hpp"

namespace lamplock::thermal::test {
namespace {

std::vector<BeamMove> path_through(const std::vector<std::pair<double, double>>& places,
                                   double speed, double power, bool is_proportional) {
  std::vector<BeamMove> moves;
  for (std::size_t i = 1; i < places.size(); ++i)
    moves.push_back({i, places[i - 1].first, places[i - 1].second, places[i].first,
                     places[i].second, speed, power, is_proportional, 0});
  return moves;
}

/// Speeds are continuous, within their limits, and pieces join.
TEST(BeamMotion, RandomPaths) {
  geometry::Random random(3);
  for (int n = 0; n < 200; ++n) {
    std::vector<std::pair<double, double>> places;
    for (int i = 0; i < 12; ++i) places.emplace_back(random.uniform() * 5, random.uniform() * 5);
    const double accel = 50 + 1000 * random.uniform();
    const auto moves = path_through(places, 1 + 50 * random.uniform(), 1, true);
    const auto pieces = beam_motion(moves, accel, 0.01 * random.uniform());
    double speed = 0;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      const MotionPiece& p = pieces[i];
      EXPECT_NEAR(p.begin_mm_s, speed, 1e-4);
      EXPECT_LE(std::max(p.begin_mm_s, p.end_mm_s), moves[p.move].speed_mm_s * (1 + 1e-9));
      EXPECT_LE(std::abs(p.end_mm_s - p.begin_mm_s), accel * p.seconds * (1 + 1e-6) + 1e-6);
      EXPECT_NEAR(p.way_at(1), 1, 1e-12);
      speed = p.end_mm_s;
      if (i == 0) continue;
      EXPECT_NEAR(std::hypot(p.x0 - pieces[i - 1].x1, p.y0 - pieces[i - 1].y1), 0, 1e-6);
    }
    EXPECT_NEAR(speed, 0, 1e-4);
  }
}

/// A turn back on a narrow row is hotter than the straight row before it, and the proposed power
/// brings it to the limit.
TEST(PathRun, TurnsOverheat) {
  const auto moves = path_through({{0, 0}, {4, 0}, {4, 0.15}, {2.5, 0.15}}, 10, 0.05, true);
  PathSetup setup{acrylic(), no_losses(), {false, 0.2, 0.2}, {}, {}};
  const PathResult result = run_path(moves, setup);
  EXPECT_LT(result.balance.relative_error(), 1e-9);
  const auto lines = hottest_of_lines(moves, result);
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_GT(lines[2].hottest.max_k - 293.15, 1.1 * (lines[0].hottest.max_k - 293.15));
  const double limit = lines[0].hottest.max_k + 0.5;
  const auto hot = overheated_lines(lines, limit, 293.15);
  ASSERT_GE(hot.size(), 1u);
  const PathResult after = run_path(with_proposed_power(moves, hot), setup);
  for (const LineHeat& line : hottest_of_lines(moves, after))
    EXPECT_LT(line.hottest.max_k - 293.15, 1.1 * (limit - 293.15)) << line.line;
  const std::string svg = path_picture(result, moves, limit, "a < b");
  EXPECT_TRUE(svg.ends_with("</svg>\n"));
  EXPECT_NE(svg.find("a &lt; b"), std::string::npos);
}

/// A beam at rest heats its middle by P/(pi^1.5 k R) atan(sqrt(4 a t)/R): Carslaw and Jaeger,
/// Conduction of Heat in Solids, section 10.5, for a Gaussian with the radius R at 1/e.
/// The usual mesh is within 10 %, the refined one within 2.5 %.
TEST(PathRun, RestsWithLight) {
  PathSetup setup{acrylic(), no_losses(), {false, 0.2, 0.2}, {}, {}};
  const double power = 0.05, radius = 0.2, diffusivity = setup.body.diffusivity_mm2_s();
  const auto rise = [&](double seconds, const Meshing& meshing) {
    BeamMove rest{.line = 1, .x0 = 3, .y0 = 2, .x1 = 3, .y1 = 2};
    rest.power_w = power;
    rest.rest_s = seconds;
    setup.meshing = meshing;
    const PathResult result = run_path({rest}, setup);
    EXPECT_LT(result.balance.relative_error(), 1e-9);
    return result.samples.back().max_k - setup.surface.ambient_k;
  };
  for (const double seconds : {0.02, 1.0}) {
    const double exact = power /
                         (std::pow(std::acos(-1.0), 1.5) * setup.body.conductivity_w_mmk * radius) *
                         std::atan(std::sqrt(4 * diffusivity * seconds) / radius);
    EXPECT_NEAR(rise(seconds, {}), exact, 0.1 * exact) << seconds;
    EXPECT_NEAR(rise(seconds, {4, std::sqrt(1.5), 0.25}), exact, 0.025 * exact) << seconds;
  }
}

/// With M3 the slow corner gets more energy than with M4.
TEST(PathRun, ConstantPowerOverheatsCorners) {
  PathSetup setup{acrylic(), no_losses(), {false, 0.2, 0.2}, {}, {}};
  setup.accel_mm_s2 = 100;
  setup.deviation_mm = 0;
  const auto max_of = [&](bool is_proportional) {
    double max = 0;
    const auto moves = path_through({{0, 0}, {2, 0}, {2, 2}}, 20, 0.05, is_proportional);
    for (const PathSample& sample : run_path(moves, setup).samples)
      max = std::max(max, sample.max_k);
    return max - 293.15;
  };
  EXPECT_GT(max_of(false), 1.2 * max_of(true));
}

/// A line that is hot where it brakes stays hot with any feed; a long one at its feed does not.
TEST(PathRun, FeedsAreProposedWhereTheyHelp) {
  PathSetup setup{acrylic(), no_losses(), {false, 0.2, 0.2}, {}, {}};
  const double ambient = setup.surface.ambient_k;
  const auto proposed = [&](bool is_proportional, double part_of_largest) {
    const auto moves = path_through({{0, 0}, {10, 0}}, 10, 0.05, is_proportional);
    const auto lines = hottest_of_lines(moves, run_path(moves, setup));
    const double limit = ambient + part_of_largest * (lines[0].hottest.max_k - ambient);
    auto hot = overheated_lines(lines, limit, ambient);
    EXPECT_EQ(hot.size(), 1u);
    const auto faster = with_proposed_feed(moves, hot);
    const auto after = hottest_of_lines(faster, run_path(faster, setup));
    const bool is_effective = after[0].hottest.max_k - ambient < 1.05 * (limit - ambient);
    keep_effective_feeds(hot, after, limit, ambient);
    EXPECT_TRUE(!hot[0].feed_factor || is_effective);
    return hot[0].feed_mm_min();
  };
  setup.accel_mm_s2 = 100;
  EXPECT_FALSE(proposed(false, 0.9)) << "hottest where it stops";
  setup.accel_mm_s2 = 1e4;
  const auto feed = proposed(true, 0.9);
  ASSERT_TRUE(feed);
  EXPECT_NEAR(*feed, 600 / (0.9 * 0.9), 1);
}

TEST(PathRun, FeedsThatDoNotHelpAreNotProposed) {
  const auto line = [](std::size_t number, double max_k) {
    LineHeat heat{number, {}, 1, 10};
    heat.hottest.max_k = max_k;
    heat.hottest.speed_mm_s = 10;
    return heat;
  };
  auto hot = overheated_lines({line(1, 500), line(2, 600), line(3, 350)}, 400, 300);
  ASSERT_EQ(hot.size(), 2u);
  ASSERT_TRUE(hot[0].feed_factor && hot[1].feed_factor);
  keep_effective_feeds(hot, {line(1, 404), line(2, 406), line(3, 350)}, 400, 300);
  EXPECT_TRUE(hot[0].feed_factor);
  EXPECT_FALSE(hot[1].feed_factor);
}

}  // namespace
}  // namespace lamplock::thermal::test
