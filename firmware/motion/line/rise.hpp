// The time of a change of speed along a line where jerk is limited, and the largest change.
//
// In:  the machine's limits; per line its acceleration.
// Out: times, and the speeds that can be reached over a distance.
// Who: look-ahead and profiles of the line planner, once or a few times per line.
//
// A phase is a pulse (pulse.hpp): its acceleration rises from zero and falls to zero again. With
// acceleration A and a rise of R ticks a pulse of n ticks changes the speed by
//
//   A n^2 / (4 R)  if n <= 2 R,   A (n - R)  otherwise.
//
// R is the same for all lines, that of the axis with the longest, so that no axis of any line
// exceeds its jerk. A pulse is never longer than a slice, so every segment begins and ends with no
// acceleration and overrides or a hold can take effect there. A change of more than half a slice is
// cut into pulses of half a slice to a slice, and planned as if all had half. The cost: where R is
// long against a slice of 16 ms, accelerations are lower, and on very short lines, with a pulse
// each, lower still. An acceleration that the jerk reaches at once, in half a stair, needs no
// pulse.
#pragma once

#include <cstdint>

#include "firmware/motion/line/real.hpp"
#include "firmware/motion/profile/limits.hpp"

namespace lamplock::motion {

struct LineRise {
  UFloat ticks;       ///< R; 0 = no limit
  UFloat half_slice;  ///< ticks of the pulses that long changes consist of
  UFloat half_share;  ///< mean acceleration of these, as a share of A
  UFloat flat_share;  ///< share of A that needs no pulse

  bool none() const { return is_zero(ticks); }
  /// Ticks for a change of speed that would take `steady_ticks` at constant A.
  UFloat change_ticks(UFloat steady_ticks) const;
};

LineRise make_rise(const Limits& limits);

/// Next speed to try in a bisection.
UFloat middle_of(UFloat low, UFloat high);

/// A line and the rise of its acceleration.
struct LineRamps {
  UFloat accel;
  const LineRise& rise;

  /// Ticks from one speed to another.
  UFloat ticks(UFloat from, UFloat to) const;
  /// Twice the distance meanwhile.
  UFloat way_2(UFloat from, UFloat to) const { return (from + to) * ticks(from, to); }
  /// Highest speed that can be reached from `speed` over `length`, or braked to it.
  UFloat highest(UFloat speed, UFloat length) const;
  /// Lowest such speed, 0 if `length` is long enough to stop.
  UFloat lowest(UFloat speed, UFloat length) const;
};

}  // namespace lamplock::motion
