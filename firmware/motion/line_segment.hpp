// From a run along a line to the motion of all axes.
//
// In:  where the machine is, the line, a run (line_profile.hpp).
// Out: a segment for the tick generator: all axes in proportion, exact at the end of the line (in
//      the middle of its steps to better than 1e-6 step; the rest is carried on).
// Called by the line planner, once per segment; some five products of 64 bits and up to three
// quotients per axis that moves.
#pragma once

#include <cstdint>

#include "firmware/motion/limits.hpp"
#include "firmware/motion/line_profile.hpp"
#include "firmware/stepper/segment.hpp"

namespace lamplock::motion {

/// The line under way.
struct LineWay {
  PerAxis<std::int64_t> steps{};  ///< from its start to its end
  Real per_length;                ///< 1 / length
  StepPosition target{};
};

/// What is left of the line along its longest axis, `longest`, over its whole: times the length.
Real length_left(const LineWay& way, Real length, int longest, const stepper::MotionState& at);

/// With `pulses` the phases have ramps that keep the jerk in `limits`.
stepper::Segment make_segment(const stepper::MotionState& from, const LineWay& way,
                              const LineRun& run, const Limits& limits, bool pulses);

/// A rest-to-rest motion of less than a step, to the middle of the step where the machine is.
stepper::Segment make_settling(const stepper::MotionState& from, std::uint32_t ticks);

}  // namespace lamplock::motion
