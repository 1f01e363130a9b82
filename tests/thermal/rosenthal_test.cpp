// A point source on a half space: Rosenthal's solution, on the track behind the source and below
// it.
#include <gtest/gtest.h>

#include <cmath>
#include <ctime>
#include <iostream>
#include <numbers>

#include "host/thermal/beam.hpp"
#include "host/thermal/heat_solver.hpp"
#include "tests/thermal/cases.hpp"

namespace lamplock::thermal::test {
namespace {

constexpr double source_w = 3, source_mm_s = 1;

/// D. Rosenthal, Trans. ASME 68, 1946: T - T0 = P / (2 pi k R) exp(-v (xi + R) / (2 alpha)), with
/// xi the distance ahead of the source.
double rosenthal(double ahead, double below) {
  const Body body = acrylic();
  const double r = std::hypot(ahead, below);
  return source_w / (2 * std::numbers::pi * body.conductivity_w_mmk * r) *
         std::exp(-source_mm_s * (ahead + r) / (2 * body.diffusivity_mm2_s()));
}

/// The half of the body at one side of the track: the plane of the track is adiabatic.
Grid half_grid(double x, double fine, double growth) {
  const Axis along(graded_nodes(-4, 16, x - 2 * fine, x + 4 * fine, {fine, growth}));
  const Axis across(graded_nodes(0, 6, 0, 2 * fine, {fine, growth}));
  return {along, across, Axis(graded_nodes(0, 6, 0, 2 * fine, {fine, growth}))};
}

TEST(Rosenthal, BehindAndBelowTheSource) {
  EXPECT_NEAR(rosenthal(-1, 0), 2513.0, 0.5);
  EXPECT_NEAR(rosenthal(-2, 0), 1256.5, 0.5);
  EXPECT_NEAR(rosenthal(-5, 0), 502.6, 0.5);
  EXPECT_NEAR(rosenthal(0, 0.1), 15940, 15);
  EXPECT_NEAR(rosenthal(0, 0.2), 5055, 5);
  EXPECT_NEAR(rosenthal(0, 0.3), 2138, 3);
  const std::clock_t begin = std::clock();
  const Body body = acrylic();
  // The end of the way has finer grids and steps: what is near forgets the begin.
  struct Part {
    double end_mm, step_s, fine_mm, reach_mm;
  };
  const Part parts[]{{7, 0.2, 0.1, 0.5}, {8.6, 0.05, 0.04, 0.2}, {9, 0.02, 0.02, 0.1}};
  double x = 0;
  HeatSolver solver(half_grid(0, 0.1, 1.3), body, no_losses());
  std::vector<double> power;
  for (const Part& part : parts) {
    double centre = -1e9;
    while (x < part.end_mm - 1e-9) {
      if (x - centre > part.reach_mm) {
        // The last grid of the way has its fine part at the end.
        centre = x;
        const double left = part.end_mm - x;
        solver.change_grid(
            half_grid(left < part.reach_mm * 2 ? part.end_mm : x, part.fine_mm, 1.25));
      }
      const double next = x + source_mm_s * part.step_s;
      // A beam of a small size is a point.
      const double radius = part.fine_mm * 0.5;
      absorbed_power(solver.grid(), body, {false, radius, radius}, {x, 0, next, 0}, source_w,
                     power);
      solver.step(part.step_s, power);
      x = next;
    }
  }
  const Grid& grid = solver.grid();
  double worst = 0;
  // Linear between nodes along one axis, of the rise times the distance, which is smooth.
  const auto check = [&](double ahead, double below, const char* name) {
    const Axis& axis = below > 0 ? grid.z : grid.x;
    const double place = below > 0 ? below : x + ahead;
    std::size_t i = axis.nearest(place);
    if (axis.node(i) > place) --i;
    const std::size_t at_source = grid.x.nearest(x);
    const auto value = [&](std::size_t n) {
      const double r = std::abs(below > 0 ? axis.node(n) : axis.node(n) - x);
      return r * solver.rises()[below > 0 ? grid.index(at_source, 0, n) : grid.index(n, 0, 0)];
    };
    const double part = (place - axis.node(i)) / axis.gap(i);
    const double rise = ((1 - part) * value(i) + part * value(i + 1)) / std::hypot(ahead, below);
    const double error = rise / rosenthal(ahead, below) - 1;
    worst = std::max(worst, std::abs(error));
    std::cout << name << " " << rise << " K, " << 100 * error << " %\n";
    EXPECT_LT(std::abs(error), 0.02) << name;
  };
  check(-1, 0, "1 mm behind");
  check(-2, 0, "2 mm behind");
  check(-5, 0, "5 mm behind");
  check(0, 0.1, "0.1 mm below");
  check(0, 0.2, "0.2 mm below");
  check(0, 0.3, "0.3 mm below");
  std::cout << grid.size() << " nodes, " << double(std::clock() - begin) / CLOCKS_PER_SEC
            << " s, balance " << solver.balance().relative_error() << "\n";
  EXPECT_LT(solver.balance().relative_error(), 1e-9);
}

}  // namespace
}  // namespace lamplock::thermal::test
