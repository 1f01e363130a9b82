#include "host/order/beat_model.hpp"

#include <gtest/gtest.h>

#include "host/bench/reference_planner.hpp"
#include "tests/order/clouds.hpp"
#include "tests/scale.hpp"

namespace lamplock {
namespace {

using geometry::Point;
using geometry::PointCloud;
using order::BeatModel;
using order::Motion;

/// A machine on which 1 mm is A beat^2 on each axis, with a speed limit in A beat.
Motion unit_machine(double limit) { return {{1, 1, 1}, {limit, limit, limit}, 1}; }

TEST(BeatModel, OneStepFromRestTakesAsLongAsAccelerationRequires) {
  const BeatModel model(unit_machine(1000));
  for (int beats = 1; beats < 20; ++beats) {
    const double furthest = 0.5 * beats * beats;  // the speed at the end is free
    EXPECT_EQ(model.beats(PointCloud{{0, 0, 0}, {furthest * 0.999, 0, 0}}), beats);
    EXPECT_EQ(model.beats(PointCloud{{0, 0, 0}, {0, 0, -furthest * 1.001}}), beats + 1);
  }
}

TEST(BeatModel, EvenRowsTakeABeatAPointUpToTheSpeedLimit) {
  const auto row = [](double step) {
    PointCloud cloud;
    for (int i = 0; i < 400; ++i) cloud.push_back({i * step, 0, 0});
    return cloud;
  };
  const BeatModel model(unit_machine(2));
  EXPECT_EQ(model.beats(row(0.5)), 399);
  EXPECT_LT(model.beats(row(1.99)), 402);
  EXPECT_GT(model.beats(row(2.01)), 2 * 398);
}

/// Furthest point of a zigzag that needs only a beat each: 1/4 to and fro.
TEST(BeatModel, ZigzagsTakeABeatAPointUpToAQuarter) {
  const auto zigzag = [](double step) {
    PointCloud cloud;
    for (int i = 0; i < 400; ++i) cloud.push_back({0, i % 2 == 0 ? 0.0 : step, 0});
    return cloud;
  };
  const BeatModel model(unit_machine(10));
  EXPECT_EQ(model.beats(zigzag(0.249)), 399);
  EXPECT_GT(model.beats(zigzag(0.27)), 410);
}

TEST(BeatModel, IsCloseToTheExactOptimum) {
  std::mt19937_64 random(51);
  std::uniform_real_distribution<double> step(-1, 1);
  long all = 0, all_optimum = 0;
  for (int i = 0; i < test::scaled(60); ++i) {
    const double size = i % 3 == 0 ? 0.4 : i % 3 == 1 ? 0.8 : 1.6;
    const double limit = i % 2 == 0 ? 2 : 50;
    PointCloud cloud{{0, 0, 0}};
    bench::ReferenceProblem problem;
    problem.axes = 3;
    problem.limit = {limit, limit, limit};
    for (int k = 0; k < 120; ++k) {
      const Point& last = cloud.back();
      const Point way{step(random) * size, step(random) * size, step(random) * size};
      cloud.push_back({last.x + way.x, last.y + way.y, last.z + way.z});
      problem.way.push_back({way.x, way.y, way.z});
    }
    const long beats = BeatModel(unit_machine(limit)).beats(cloud);
    const long optimum = bench::fewest_beats(problem).beats;
    // The optimum also comes to rest at the end, which may take some beats more.
    EXPECT_GE(beats, optimum - 4);
    EXPECT_LE(static_cast<double>(beats), 1.08 * static_cast<double>(optimum));
    all += beats;
    all_optimum += optimum;
  }
  EXPECT_LE(static_cast<double>(all), 1.04 * static_cast<double>(all_optimum));
}

TEST(BeatModel, PointsInOnePlaceTakeABeatEach) {
  EXPECT_EQ(BeatModel(Motion{}).beats(PointCloud(100, Point{1, 2, 3})), 99);
  EXPECT_EQ(BeatModel(Motion{}).beats(PointCloud{}), 0);
  EXPECT_EQ(BeatModel(Motion{}).beats(PointCloud{{1, 2, 3}}), 0);
}

}  // namespace
}  // namespace lamplock
