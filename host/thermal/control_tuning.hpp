// Settings of the controller that holds a temperature by speed or power, and its simulated
// response.
//
// In:  a plant, a settling time, an overshoot. Out: Kp, Ki, the response. Who: `heat --tune`.
//
//   plant       K / (tau s + 1),  controller  u = Ki integral(r - y) - Kp y  (I-P: the set point
//   acts
//               through the integral alone, so the closed loop has no zero)
//   closed loop omega^2 / (s^2 + 2 zeta omega s + omega^2):
//               Ki = omega^2 tau / K,   Kp = (2 zeta omega tau - 1) / K
//   overshoot   exp(-pi zeta / sqrt(1 - zeta^2))
#pragma once

#include <vector>

#include "host/thermal/straight_run.hpp"

namespace lamplock::thermal {

struct LoopGoal {
  double settling_s = 0.05, overshoot = 0.028;
  double band = 0.05;  ///< settled: the deviation remains within this part of the step
};

struct LoopSettings {
  double zeta = 0, omega_rad_s = 0;
  double kp = 0, ki_per_s = 0;  ///< in parts of the power (or speed) per K
};
/// Throws Error(bad_input) if the goal is out of range, or so slow that Kp would be negative.
LoopSettings tuned_loop(const Plant& plant, const LoopGoal& goal);

/// Samples of the loop: the temperature's deviation and the controller's output.
struct LoopResponse {
  std::vector<double> times_s{}, deviations_k{}, outputs{};
  double settling_s = 0;  ///< into the band, to stay
  double overshoot = 0;   ///< over the step, or over the first extreme after a disturbance
};
/// The set point rises by `step_k`.
LoopResponse set_point_step(const Plant& plant, const LoopSettings& loop, const LoopGoal& goal,
                            double step_k);
/// The absorbed part of the power rises by a part of itself, at an output of 1. Settled: within the
/// band of the first extreme.
LoopResponse absorption_step(const Plant& plant, const LoopSettings& loop, const LoopGoal& goal,
                             double part);

}  // namespace lamplock::thermal
