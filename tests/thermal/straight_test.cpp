// A beam on a straight line: against closed solutions, pairs of speed and power, refinement.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numbers>

#include "host/error.hpp"
#include "host/thermal/straight_run.hpp"
#include "tests/thermal/cases.hpp"

namespace lamplock::thermal::test {
namespace {

/// Largest rise of the surface of a half space below a moving Gaussian beam (H. E. Cline and T. R.
/// Anthony, J. Appl. Phys. 48, 1977), w at 1/e: the sum over the heat of all moments t ago,
/// 2 P / (rho c) exp(-(x + v t)^2 / (w^2 + 4 a t)) / (pi (w^2 + 4 a t) sqrt(4 pi a t)).
double gaussian_rise(const Body& body, double w, double speed, double power) {
  const double a = body.diffusivity_mm2_s(), end = std::sqrt(200 * w * w / a), step = end / 20'000;
  double max = 0;
  for (double x = -3 * w; x <= 0; x += w / 20) {
    double sum = 0;
    // t = s^2 removes the singularity at 0.
    for (double s = step / 2; s < end; s += step) {
      const double t = s * s, spread = w * w + 4 * a * t;
      sum += std::exp(-(x + speed * t) * (x + speed * t) / spread) /
             (std::numbers::pi * spread * std::sqrt(4 * std::numbers::pi * a)) * 2 * step;
    }
    max = std::max(max, 2 * power / body.heat_j_mm3k * sum);
  }
  return max;
}

TEST(StraightRun, MovingGaussianBeam) {
  const StraightSetup setup{acrylic(), no_losses(), {false, 0.2, 0.2}, {}, {}};
  for (const double speed : {5.0, 40.0}) {
    const StraightResult result = straight_run(setup, speed, 0.1);
    const double ratio = (result.max_k - 293.15) / gaussian_rise(setup.body, 0.2, speed, 0.1);
    std::cout << speed << " mm/s: " << 100 * (ratio - 1) << " %\n";
    EXPECT_NEAR(ratio, 1, 0.05) << speed;
    EXPECT_TRUE(result.is_steady) << speed;
  }
}

/// Losses are in the balance, and a pair that holds a temperature has it in a run of its own.
TEST(StraightRun, HoldsATemperature) {
  const Surface surface{293.15, 500e-6, 0.9, {}};
  const StraightSetup setup{acrylic(), surface, {false, 0.2, 0.2}, {}, {}};
  const HeldPair pair = held_pair(setup, 8, 450);
  EXPECT_NEAR(straight_run(setup, 8, pair.power_w).max_k, 450, 0.003 * (450 - 293.15));
  EXPECT_TRUE(pair.at.is_steady);
  EXPECT_LT(pair.at.balance.relative_error(), 1e-9);
  EXPECT_GT(pair.at.losses_w.radiation, 0);
  StraightSetup lossless = setup;
  lossless.surface = no_losses();
  EXPECT_LT(held_pair(lossless, 8, 450).power_w, pair.power_w);
  EXPECT_THROW((void)held_pair(setup, 2, 290), Error);
}

}  // namespace
}  // namespace lamplock::thermal::test
