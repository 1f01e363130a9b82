// The motion of a beam along a program: speed and power at each place.
//
// In:  moves of a program, an acceleration, the deviation at corners. Out: straight pieces with
//      constant acceleration and the power at their ends. Who: run_path().
//
// Speeds are trapezoids over the whole path. A corner is passed with the speed of an arc that
// deviates from it by the junction deviation, as in grbl: v^2 = a d s / (1 - s), s = sin(angle /
// 2).
#pragma once

#include <cstddef>
#include <vector>

namespace lamplock::thermal {

/// A straight move, or a time at rest.
struct BeamMove {
  std::size_t line = 0;  ///< of the program
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  double speed_mm_s = 0;
  double power_w = 0;            ///< of the beam; 0: dark
  bool is_proportional = false;  ///< M4: the power follows the speed
  double rest_s = 0;             ///< of a dwell
};

struct MotionPiece {
  std::size_t move = 0;  ///< its index
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  double seconds = 0, begin_mm_s = 0, end_mm_s = 0;

  /// Part of the way, 0..1, after a part of the time.
  double way_at(double part) const;
};

/// A deviation of 0: a stop at each corner of more than 0.1 degrees.
std::vector<MotionPiece> beam_motion(const std::vector<BeamMove>& moves, double accel_mm_s2,
                                     double deviation_mm);

}  // namespace lamplock::thermal
