// Look-ahead: how fast the machine may be at every joint so that it can stop at the last one.
//
// In:  the ring of lines, the overrides.
// Out: the planned speed at the start of every line but the first, which is under way.
// Called by the line planner, when the end of the line under way is not settled yet and there is
// something new.
//
// From the back: at the end of the last line the machine stands; what it may enter a line with is
// what braking along it takes away, and no more than the joint allows. Where the joint decides, no
// further line changes anything before it: the next pass ends there (`settled`). A pass is made
// only if a speed is wanted that is not settled, so with a full ring a line is visited once or
// twice in its life. Where the ring is too short to settle anything, the lines so short that all of
// it is less than a braking distance, a pass waits for a 32nd of the lines, which costs at most 1.6
// % of the speed; there a line is visited up to 32 times, 170 cycles of the Cortex-M0+ each.
#pragma once

#include <cstdint>

#include "firmware/motion/line_ring.hpp"
#include "firmware/motion/line_rise.hpp"

namespace lamplock::motion {

/// Factors that the user sets while the machine runs.
struct LineOverride {
  LineReal feed = LineReal::power(0);
  LineReal rapid = LineReal::power(0);
  bool plain = true;  ///< feed is 1
};

/// Speed to run a line at where nothing is in the way.
LineReal nominal_speed(const Line& line, const LineOverride& factor);

class LineLookahead {
 public:
  /// Limits have changed: nothing is settled.
  void reset() { stale_ = true; }
  /// Squared speed at the end of the first line in the ring.
  LineReal exit_speed_2(LineRing& ring, const LineOverride& factor, const LineRise& rise);

 private:
  void plan(LineRing& ring, const LineOverride& factor, const LineRise& rise);

  std::uint32_t settled_ = 0;  ///< the joint up to which nothing changes any more
  std::uint32_t end_ = 0;      ///< of the ring in the last pass
  bool stale_ = true;
};

}  // namespace lamplock::motion
