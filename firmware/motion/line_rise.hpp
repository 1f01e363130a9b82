// How long a change of speed takes along a line where jerk is limited, and what it can come to.
//
// In:  the machine's limits; per line its acceleration.
// Out: times, and the speeds that can be had over a way.
// Called by look-ahead and profiles of the line planner, once or a few times per line.
//
// A phase is a pulse (pulse.hpp): its acceleration rises from zero and falls to zero again. With
// acceleration A and a rise of R ticks a pulse of n ticks changes the speed by
//
//   A n^2 / (4 R)  if n <= 2 R,   A (n - R)  otherwise.
//
// R is the same for all lines, that of the axis with the longest, so that no axis of any line has
// more jerk than it may. A pulse never is longer than a slice, so that every segment begins and
// ends with no acceleration and whatever is in force can change there. What takes more than half a
// slice is cut into pulses of half a slice to a slice, and planned as if all had half. That is the
// price: where R is long against a slice of 16 ms, accelerations come out low, and on very short
// lines, with a pulse each, lower still. An acceleration that the jerk gives at once, in half a
// stair, needs no pulse.
#pragma once

#include <cstdint>

#include "firmware/motion/limits.hpp"
#include "firmware/motion/line_real.hpp"

namespace lamplock::motion {

struct LineRise {
  LineReal ticks;       ///< R; 0 = no limit
  LineReal half_slice;  ///< ticks of the pulses that long changes consist of
  LineReal half_share;  ///< of A, that they are worth
  LineReal flat_share;  ///< of A, that needs no pulse

  bool none() const { return is_zero(ticks); }
  /// Ticks for a change of speed that would take `steady_ticks` at A all along.
  LineReal change_ticks(LineReal steady_ticks) const;
};

LineRise make_rise(const Limits& limits);

/// Where to look next for a speed between two.
LineReal middle_of(LineReal low, LineReal high);

/// A line and the rise of its acceleration.
struct LineRamps {
  LineReal accel;
  const LineRise& rise;

  /// Ticks from one speed to another.
  LineReal ticks(LineReal from, LineReal to) const;
  /// Twice the way meanwhile.
  LineReal way_2(LineReal from, LineReal to) const { return (from + to) * ticks(from, to); }
  /// Highest speed to be had from `speed` over `length`, or to come down from.
  LineReal highest(LineReal speed, LineReal length) const;
  /// Lowest, 0 if there is length to spare.
  LineReal lowest(LineReal speed, LineReal length) const;
};

}  // namespace lamplock::motion
