// Converts a run along a line to the motion of all axes.
//
// In:  the state of the machine, the line, a run (line/profile.hpp).
// Out: a segment for the tick generator: all axes in proportion, exact at the end of the line (to
//      better than 1e-6 step; the rest is carried on).
// Who: the line planner, once per segment; a steady speed takes the Cortex-M0+ 600 cycles per axis
//      that moves, a changing one a division of 64 bits and two products more per phase.
#pragma once

#include <cstdint>

#include "firmware/motion/line/place.hpp"
#include "firmware/motion/line/profile.hpp"
#include "firmware/motion/profile/limits.hpp"
#include "firmware/stepper/segment.hpp"

namespace lamplock::motion {

/// The present line.
struct LineWay {
  WayParts way;       ///< from its start to its end
  UFloat per_length;  ///< steps of a part / length
  LinePlace target;
};

/// The rest of the line along its longest axis, `longest`, over its whole: times the length.
UFloat length_left(const LineWay& way, UFloat length, int longest, const stepper::MotionState& at);

/// Fills a segment; with `pulses` its phases have ramps that keep the jerk of `limits`.
void make_segment(const stepper::MotionState& from, const LineWay& way, const LineRun& run,
                  const Limits& limits, bool pulses, stepper::Segment& out);

/// A rest-to-rest motion of less than a step, to the middle of the present step.
stepper::Segment make_settling(const stepper::MotionState& from, std::uint32_t ticks);

}  // namespace lamplock::motion
