// The heat solver against closed solutions: half space with constant flux, decay of a cosine;
// energy balance of random cases; orders of convergence.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numbers>

#include "host/geometry/random.hpp"
#include "host/thermal/beam.hpp"
#include "host/thermal/heat_solver.hpp"
#include "tests/scale.hpp"
#include "tests/thermal/cases.hpp"

namespace lamplock::thermal::test {
namespace {

using std::numbers::pi;

/// Carslaw and Jaeger, "Conduction of Heat in Solids", 2.9: T - T0 = 2 q / k sqrt(alpha t / pi).
double half_space_rise(const Body& body, double flux_w_mm2, double seconds) {
  return 2 * flux_w_mm2 / body.conductivity_w_mmk *
         std::sqrt(body.diffusivity_mm2_s() * seconds / pi);
}

TEST(HeatSolver, HalfSpaceWithConstantFlux) {
  const Grid grid{Axis::single(1), Axis::single(1), Axis(depth_nodes(4, 50, 1.03))};
  HeatSolver solver(grid, acrylic(), no_losses());
  const std::vector<double> power = into_surface(grid, 1e4 / w_m2_per_w_mm2);
  EXPECT_NEAR(half_space_rise(acrylic(), 0.01, 1), 19.682, 0.0005);
  EXPECT_NEAR(half_space_rise(acrylic(), 0.01, 5), 44.010, 0.0005);
  for (int i = 0; i < 20; ++i) solver.step(0.05, power);
  std::cout << "1 s: " << solver.rises()[0] / 19.682 - 1;
  EXPECT_NEAR(solver.rises()[0], 19.682, 0.003 * 19.682);
  for (int i = 20; i < 100; ++i) solver.step(0.05, power);
  std::cout << ", 5 s: " << solver.rises()[0] / 44.010 - 1 << ", balance "
            << solver.balance().relative_error() << "\n";
  EXPECT_NEAR(solver.rises()[0], 44.010, 0.003 * 44.010);
  EXPECT_LT(solver.balance().relative_error(), 1e-12);
}

/// Beer and Lambert: early, before heat flows, the rise is S t / (rho c) at each depth.
TEST(HeatSolver, BeamIsAbsorbedInDepth) {
  Body body = acrylic();
  body.absorption_per_mm = 2;
  body.absorption = 0.96;
  const Grid grid = column(5, 101);
  HeatSolver solver(grid, body, no_losses());
  std::vector<double> power;
  // A beam far wider than the column: uniform intensity.
  absorbed_power(grid, body, {true, 10, 10}, {}, 400, power);
  solver.step(1e-3, power);
  for (std::size_t k = 1; k < 100; k += 7) {
    const double expected = 0.96 * 2 * std::exp(-2 * grid.z.node(k)) * 1e-3 / body.heat_j_mm3k;
    EXPECT_NEAR(solver.rises()[k], expected, 2e-3 * expected) << grid.z.node(k);
  }
  double sum = 0;
  for (const double one : power) sum += one;
  EXPECT_NEAR(sum, 0.96 * (1 - std::exp(-10.0)), 1e-12);
}

/// Random grids, materials, beams, steps and losses.
TEST(HeatSolver, EnergyIsBalanced) {
  geometry::Random random(7);
  double worst = 0;
  for (int n = 0; n < lamplock::test::scaled(24, 8); ++n) {
    const auto between = [&](double low, double high) {
      return low * std::pow(high / low, random.uniform());
    };
    const bool is_flat = n % 2 == 0;
    const double depth = between(0.5, 20), size = between(2, 20);
    const Axis across = is_flat
                            ? Axis::single(1)
                            : Axis(graded_nodes(-size, size, -0.2, 0.3, {0.25, between(1.8, 2.5)}));
    const Grid grid{across, across,
                    Axis(graded_nodes(0, depth, 0, 0.05, {between(0.03, 0.1), 1.7}))};
    Body body{between(1e-4, 0.4), between(5e-4, 4e-3), random.uniform(), {}};
    if (random.uniform() < 0.5) body.absorption_per_mm = between(0.1, 100);
    Surface surface = hot_surface();
    if (n % 3 == 0) surface.evaporation.reset();
    HeatSolver solver(grid, body, surface);
    const double power_w = between(0.01, 100);
    std::vector<double> power;
    for (int i = 0; i < 8; ++i) {
      const double x = random.uniform(), y = random.uniform();
      absorbed_power(solver.grid(), body, {random.uniform() < 0.5, 0.2, 0.3}, {0, 0, x, y}, power_w,
                     power);
      solver.step(between(1e-4, 1), power);
      if (i == 4 && !is_flat)
        solver.change_grid({Axis(graded_nodes(-size, size, x - 0.2, x + 0.2, {0.2, 2})),
                            Axis(graded_nodes(-size, size, y - 0.2, y + 0.2, {0.2, 2})), grid.z});
    }
    worst = std::max(worst, solver.balance().relative_error());
    EXPECT_LT(solver.balance().relative_error(), 1e-9) << n;
    EXPECT_GE(solver.balance().lost_j.total(), 0) << n;
  }
  std::cout << "largest error of the balance " << worst << "\n";
}

/// A cosine over the depth decays by exp(-alpha (pi/L)^2 t); both ends are adiabatic.
double cosine_error(std::size_t nodes, double step_s, int steps) {
  const Body body = acrylic();
  const double depth = 2, rate = body.diffusivity_mm2_s() * pi * pi / (depth * depth);
  const Grid grid = column(depth, nodes);
  HeatSolver solver(grid, body, no_losses());
  // The cosine is brought in as power over a step, which is a smooth source S(x) constant in time:
  // u = S / (rho c rate) (1 - exp(-rate t)) cos(pi x / L).
  std::vector<double> power(grid.size());
  for (std::size_t k = 0; k < nodes; ++k)
    power[k] = (std::sin(pi * grid.z.face(k + 1) / depth) - std::sin(pi * grid.z.face(k) / depth)) *
               depth / pi * body.heat_j_mm3k * rate;
  for (int i = 0; i < steps; ++i) solver.step(step_s, power);
  double max = 0;
  for (std::size_t k = 0; k < nodes; ++k)
    max = std::max(max, std::abs(solver.rises()[k] - (1 - std::exp(-rate * step_s * steps)) *
                                                         std::cos(pi * grid.z.node(k) / depth)));
  return max;
}

TEST(HeatSolver, OrderOfConvergence) {
  const double space = std::log2(cosine_error(11, 1e-3, 2000) / cosine_error(21, 1e-3, 2000));
  const double time = std::log2(cosine_error(1601, 1, 4) / cosine_error(1601, 0.5, 8));
  std::cout << "order in space " << space << ", in time " << time << "\n";
  EXPECT_NEAR(space, 2, 0.1);
  EXPECT_NEAR(time, 2, 0.2);
}

/// A thin, well conducting plate has one temperature: rho c d dT/dt = q - losses(T).
TEST(HeatSolver, LossesAreThoseOfTheSurface) {
  const Body body{0.4, 3.4e-3, 1, {}};
  const Surface surface = hot_surface();
  const Grid grid = column(0.1, 5);
  HeatSolver solver(grid, body, surface);
  const double flux = 0.05;
  for (int i = 0; i < 4000; ++i) solver.step(0.005, into_surface(grid, flux));
  // By the classical method of Runge and Kutta.
  double t = surface.ambient_k;
  const double step = 1e-3, heat = body.heat_j_mm3k * 0.1;
  const auto rate = [&](double at) { return (flux - losses_at(surface, at).total()) / heat; };
  for (int i = 0; i < 20'000; ++i) {
    const double k1 = rate(t), k2 = rate(t + step / 2 * k1), k3 = rate(t + step / 2 * k2),
                 k4 = rate(t + step * k3);
    t += step / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  EXPECT_NEAR(solver.temperature_k(0), t, 0.02);
}

TEST(SurfaceLoss, ValuesAndSlopes) {
  const Surface black{293, 10e-6, 1, {}};
  EXPECT_NEAR(losses_at(black, 1000).radiation * w_m2_per_w_mm2, 56.3e3, 50);
  EXPECT_NEAR(losses_at(black, 2000).radiation * w_m2_per_w_mm2, 907e3, 500);
  EXPECT_NEAR(losses_at(black, 1000).convection * w_m2_per_w_mm2, 7.1e3, 50);
  EXPECT_NEAR(losses_at(black, 2000).convection * w_m2_per_w_mm2, 17.1e3, 50);
  const Surface hot = hot_surface();
  for (double t = 250; t < 450; t += 7) {
    const double d = 1e-3;
    const double slope = (losses_at(hot, t + d).total() - losses_at(hot, t - d).total()) / (2 * d);
    EXPECT_NEAR(loss_slope(hot, t), slope, 1e-6 * std::abs(slope)) << t;
  }
}

}  // namespace
}  // namespace lamplock::thermal::test
