// Where the power of a beam is absorbed: shares of the volumes of a grid, integrated exactly.
//
// In:  the profile of a beam, a grid, the way of its middle in a time step. Out: W per volume.
// Who: the runs of this room.
//
// Across the beam I = P/(pi wx wy) exp(-(x/wx)^2 - (y/wy)^2), with radii at 1/e of the intensity in
// the middle, or the same everywhere in a rectangle. In depth Beer and Lambert: exp(-mu z).
#pragma once

#include <vector>

#include "host/thermal/constants.hpp"
#include "host/thermal/grid.hpp"

namespace lamplock::thermal {

struct BeamProfile {
  bool is_rectangle = false;
  /// Radii at 1/e, or half the sides of a rectangle, mm.
  double half_x_mm = 0.1, half_y_mm = 0.1;

  /// The smaller one: what a grid has to resolve.
  double radius_mm() const { return half_x_mm < half_y_mm ? half_x_mm : half_y_mm; }
  /// Intensity in the middle over the power, 1/mm2.
  double peak_per_mm2() const;
};

/// Shares of the power in the volumes of an axis, of a beam with its middle at `centre`.
std::vector<double> lateral_shares(const Axis& axis, double half_mm, bool is_rectangle,
                                   double centre);
/// Shares in depth. What reaches the lower end is not absorbed.
std::vector<double> depth_shares(const Axis& depth, const Body& body);

/// The middle of a beam in one time step.
struct BeamWay {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// Mean power that each volume absorbs, W, of `power_w` at the end of the optics. `power` has the
/// size of the grid and is replaced.
void absorbed_power(const Grid& grid, const Body& body, const BeamProfile& beam, const BeamWay& way,
                    double power_w, std::vector<double>& power);

}  // namespace lamplock::thermal
