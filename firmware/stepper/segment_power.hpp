// The power of a continuous laser over a segment.
//
// In:  power at the start, in between and at the end of a segment, 65535 = full; it changes evenly
//      over lead and tail. Out: its value at every tick.
// Who: set_power(): the maker of the segment (main loop, or the core that plans), two 32-bit
//      divisions. The rest: the tick generator (fill interrupt), power_axis() once a segment,
//      power_from() once a power cell, one product.
//
// Lead, cruise and tail are those of the first axis that moves; on a line all axes that move have
// the same. The laser is dark where no axis moves, because a beam at rest burns: only a segment
// made by rest_with_light() shines at rest.
//
// Slopes are rounded towards zero, so that power never leaves the range between its ends: it is
// counted modulo 2^32 and would wrap. The deficit at the end of a phase is less than one bit for
// each 2^16 ticks of it.
#pragma once

#include <cstdint>

#include "firmware/stepper/segment.hpp"

namespace lamplock::stepper {

/// Power at three moments, 65535 = full.
struct PowerPoints {
  std::uint16_t start = 0, cruise = 0, end = 0;
};

/// Writes power into a segment whose axes and ticks are already set, and which has no shot. If all
/// powers are 0, the segment does not change.
void set_power(Segment& segment, const PowerPoints& power);

/// Makes a segment of `ticks` ticks in which every axis rests at `at` and the laser has one power.
/// Its start and the tick of its end are set by its user.
Segment rest_with_light(const MotionState& at, std::uint32_t ticks, std::uint16_t power);

/// Some axis moves, or the segment is made for light at rest.
bool may_shine(const Segment& segment);

/// The axis whose phases the power of a segment follows; negative if it does not shine.
int power_axis(const Segment& segment);

/// Ticks over which power changes evenly.
struct PowerStretch {
  std::uint32_t power_q16 = 0;  ///< at the first tick, with a fraction of 16 bits
  std::uint32_t slope_q16 = 0;  ///< per tick, modulo 2^32
  std::uint32_t ticks = 0;
};
/// The stretch at tick `at` of a segment that shines; `phases` are those of its power_axis().
PowerStretch power_from(const SegmentPower& power, const AxisProfile& phases, std::uint32_t at);

}  // namespace lamplock::stepper
