// From a run along a line to the motion of all axes.
//
// In:  where the machine is, the line, a run (line_profile.hpp).
// Out: a segment for the tick generator: all axes in proportion, exact at the end of the line (at
//      its place to better than 1e-6 step; the rest is carried on).
// Called by the line planner, once per segment; a steady speed takes the Cortex-M0+ 600 cycles per
// axis that moves, one that changes a division of 64 bits and two products more per phase.
#pragma once

#include <cstdint>

#include "firmware/motion/limits.hpp"
#include "firmware/motion/line_place.hpp"
#include "firmware/motion/line_profile.hpp"
#include "firmware/stepper/segment.hpp"

namespace lamplock::motion {

/// The line under way.
struct LineWay {
  WayParts way;         ///< from its start to its end
  LineReal per_length;  ///< steps of a part / length
  LinePlace target;
};

/// What is left of the line along its longest axis, `longest`, over its whole: times the length.
LineReal length_left(const LineWay& way, LineReal length, int longest,
                     const stepper::MotionState& at);

/// Fills a segment; with `pulses` its phases have ramps that keep the jerk in `limits`.
void make_segment(const stepper::MotionState& from, const LineWay& way, const LineRun& run,
                  const Limits& limits, bool pulses, stepper::Segment& out);

/// A rest-to-rest motion of less than a step, to the middle of the step where the machine is.
stepper::Segment make_settling(const stepper::MotionState& from, std::uint32_t ticks);

}  // namespace lamplock::motion
