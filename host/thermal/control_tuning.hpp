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

#include <optional>
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

/// The loop as a board runs it: once a period, with a power that acts after a delay. From a change
/// of the power to the voltage at SENSOR, docs/thermal.md, 9.
struct BoardLoop {
  double period_s = 1e-3, delay_s = 4e-3;
};
/// As absorption_step(); a settling time of infinity: it oscillates.
LoopResponse board_absorption_step(const Plant& plant, const LoopSettings& loop,
                                   const LoopGoal& goal, double part, const BoardLoop& board);
/// It settles, and overshoots by at most a quarter of the first deviation.
bool is_calm(const LoopResponse& response);
/// The shortest settling time, to a tenth, with which the loop on the board is calm; empty: none.
std::optional<double> shortest_on_board(const Plant& plant, const LoopGoal& goal, double part,
                                        const BoardLoop& board);

}  // namespace lamplock::thermal
