// Look-ahead: the maximum speed at every joint so that the machine can stop at the last one.
//
// In:  the ring of lines, the overrides.
// Out: the planned speed at the start of every line but the first, which is in progress.
// Who: the line planner, when the end of the present line is not settled yet and there are new
//      lines or limits.
//
// Backwards: at the end of the last line the machine is at rest; the entry speed of a line is the
// speed that braking along it removes, limited by the joint. Where the joint limits, no later line
// changes the speeds before it: the next pass ends there (`settled`). A pass is made only if a
// required speed is not settled, so with a full ring a line is visited once or twice in its life.
// If the ring is too short to settle a speed, because all of its lines are less than a braking
// distance, a pass waits for a 32nd of the lines, which costs at most 1.6 % of the speed; there a
// line is visited up to 32 times, 170 cycles of the Cortex-M0+ each.
#pragma once

#include <cstdint>

#include "firmware/motion/line/ring.hpp"
#include "firmware/motion/line/rise.hpp"

namespace lamplock::motion {

/// Factors that the user sets while the machine runs.
struct LineOverride {
  UFloat feed = UFloat::power(0);
  UFloat rapid = UFloat::power(0);
  bool plain = true;  ///< feed is 1
};

/// Speed of a line where nothing else limits it.
UFloat nominal_speed(const Line& line, const LineOverride& factor);

class LineLookahead {
 public:
  /// The last line of the ring has become longer, and the corner at its start may have changed.
  void extend(const LineRing& ring, const LineRise& rise);
  /// Limits have changed: no joint is settled.
  void reset() { stale_ = true; }
  /// Squared speed at the end of the first line in the ring.
  UFloat exit_speed_2(LineRing& ring, const LineOverride& factor, const LineRise& rise);

 private:
  void plan(LineRing& ring, const LineOverride& factor, const LineRise& rise);

  std::uint32_t settled_ = 0;  ///< the joint up to which speeds are final
  std::uint32_t end_ = 0;      ///< of the ring in the last pass
  bool stale_ = true;
};

}  // namespace lamplock::motion
