// A beam along a straight line until the temperature below it is steady; pairs of speed and power
// that hold a temperature; the response to a step of the power.
//
// In:  a material, a beam, speed, power. Out: the largest temperature of the surface, where the
//      power goes. Who: `lamplock heat --hold`, `--tune`, and the check of a program's mesh.
//
// Half of the body is computed; the plane of the track is its plane of symmetry. The body is larger
// than a hundred radii of the beam in each direction, or as thick as the sheet.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "host/thermal/moving_field.hpp"

namespace lamplock::thermal {

struct StraightSetup {
  Body body{};
  Surface surface{};
  BeamProfile beam{};
  Meshing meshing{};
  std::optional<double> thickness_mm{};  ///< none: thick
};

struct StraightResult {
  double max_k = 0;        ///< of the surface
  bool is_steady = false;  ///< false: it still changes by more than 0.2 % per radius
  std::size_t steps = 0;   ///< of time
  Losses losses_w{};       ///< of the whole surface at the end
  double absorbed_w = 0;
  EnergyBalance balance{};
};
/// `each_step`, if any, is called at the end of each time step. Throws Error(job_failed) if the
/// equations do not converge.
StraightResult straight_run(const StraightSetup& setup, double speed_mm_s, double power_w,
                            const std::function<void()>& each_step = {});

struct HeldPair {
  double speed_mm_s = 0, power_w = 0;
  StraightResult at{};
};
/// The power with which the surface reaches `hold_k` at this speed, to 0.2 % of the rise. Throws
/// Error(bad_input) for a temperature that is not above ambient, Error(job_failed).
HeldPair held_pair(const StraightSetup& setup, double speed_mm_s, double hold_k);

/// The same with half the mesh and half the step.
StraightSetup refined(const StraightSetup& setup);

/// The plant of the controller: dT = gain * dP/P after a step of the power, with a first-order lag.
struct Plant {
  double gain_k = 0, time_constant_s = 0;
};
/// From the steady state, the power rises by 10 %. The time constant is where 63.2 % are reached.
Plant measured_plant(const StraightSetup& setup, double speed_mm_s, double power_w);

}  // namespace lamplock::thermal
