// Where lines of a program end: a step, and the offset from its middle.
//
// In:  programmed places, rounded once (machine/runners/program_motion.hpp); where the machine
//      rests.
// Out: places to 1/256 step, and the ways between them.
// Who: the line planner, once or a few times per line pushed.
//
// The step of a place is the nearest to the programmed position, and the place is inside it, so a
// machine that stops there is exactly on that step. A place is at least `edge_q8` away from the
// edges of its step, where a pulse is due: axes reverse only at ends of lines, so an axis that
// reverses has at least the time of a sixteenth of a step between a pulse and the one back.
//
// The same holds for motors that make sums and differences of two axes (CoreXY): the offsets of
// both axes together are at most the offset allowed for one. So a line of a CoreXY ends up to a
// third of a step from the end on a Cartesian machine, on the same step.
#pragma once

#include <cstdint>

#include "firmware/stepper/segment.hpp"
#include "shared/fixed_point.hpp"
#include "shared/units.hpp"

namespace lamplock::motion {

/// Fractional bits of a place.
inline constexpr int place_bits = 8;
/// Minimum distance of a place from the edge of its step: 1/32.
inline constexpr int edge_q8 = 8;
/// Maximum offset from the middle of its step.
inline constexpr int max_off_q8 = (1 << (place_bits - 1)) - edge_q8;

/// Where an axis ends a line.
struct LinePlace {
  StepPosition steps{};
  PerAxis<std::int8_t> off_q8{};  ///< from the middle of the step, at most `max_off_q8`
};

/// Limits X and Y so that their sum and difference are inside the steps of the motors, too.
constexpr void keep_in_motor_steps(LinePlace& place) {
  std::int8_t &x = place.off_q8[0], &y = place.off_q8[1];
  const int size_x = x < 0 ? -x : x, size_y = y < 0 ? -y : y;
  const int over = size_x + size_y - max_off_q8;
  if (over <= 0) return;
  // Reduces both equally: neither can be below half of the excess.
  const int new_x = size_x - over / 2, new_y = max_off_q8 - new_x;
  x = static_cast<std::int8_t>(x < 0 ? -new_x : new_x);
  y = static_cast<std::int8_t>(y < 0 ? -new_y : new_y);
}

/// Position of an axis in the format of the tick generator.
constexpr Int128 position_of(const LinePlace& place, std::size_t a) {
  constexpr std::uint64_t unit_q64 = std::uint64_t{1} << (64 - place_bits);
  const Int128 middle = stepper::middle_of_step(place.steps[a]);
  // The sum stays inside the step.
  return {static_cast<std::uint64_t>(middle.hi()),
          middle.lo() + static_cast<std::uint64_t>(std::int64_t{place.off_q8[a]}) * unit_q64};
}

/// The place nearest to the position of the machine; it may be at an edge.
LinePlace place_of(const stepper::MotionState& at);

/// A displacement.
struct WayParts {
  PerAxis<std::int64_t> parts{};  ///< magnitudes have 32 bits
  int bits = 0;                   ///< fractional bits of a part
};

/// The displacement between two places. If its parts would not fit, it is in whole steps, with at
/// least one for each axis that moves.
WayParts way_between(const LinePlace& from, const LinePlace& to);

}  // namespace lamplock::motion
