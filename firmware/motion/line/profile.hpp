// The run of the machine along a line, or along the next piece of it.
//
// In:  the rest of the line, the present speed, the speeds planned for the line and its end.
// Out: a run of up to three phases, each a whole number of ticks: to the end of the line if that is
//      at most a slice away, or else a slice of it.
// Who: the line planner, once per segment.
//
// The textbook phases, acceleration, cruise and deceleration, do not last whole ticks. Within a
// line that does not matter: a slice ends earlier, and the rest is planned again. The run to the
// end of a line must be exact. Each phase is rounded up; over these ticks the planned speeds lead a
// little too far, by less than the distance of two ticks:
//   * where there is a phase above both ends the speed in the middle is lowered, and the ends are
//     as planned;
//   * otherwise all speeds of the run are lowered in proportion. So at the joints of a path of very
//     short lines, n ticks each, the speed may jump by up to 4/n of itself, which is the distance
//     of a few ticks: the position is never further than that from the one without rounding.
// Both only lower speeds and accelerations, so limits are kept. A run whose time is a whole number
// already is not slowed.
#pragma once

#include <cstdint>

#include "firmware/motion/line/real.hpp"
#include "firmware/motion/line/rise.hpp"

namespace lamplock::motion {

/// What a run must achieve.
struct LineTask {
  UFloat length;  ///< to the end of the line, > 0
  UFloat start;   ///< speed now
  UFloat end;     ///< planned for the end of the line
  UFloat speed;   ///< to run at
  UFloat accel;
  const LineRise* rise = nullptr;  ///< of the acceleration
  bool stop = false;               ///< stop as early as possible
  std::uint32_t slice_ticks = 0;
};

/// The result. Speeds are those at the ends of phases.
struct LineRun {
  UFloat start, cruise, end;
  std::uint32_t lead_ticks = 0, cruise_ticks = 0, tail_ticks = 0;
  bool whole = false;  ///< ends exactly at the end of the line
  UFloat next;         ///< speed planned for the next run; `end` except for rounding

  std::uint32_t ticks() const { return lead_ticks + cruise_ticks + tail_ticks; }
};

/// A run of no ticks if it must stop and is at rest.
LineRun make_run(const LineTask& task);

/// Speed at which the rest of a line takes `ticks`, with ends and acceleration as in `task`; the
/// speed of the task if there is none.
UFloat speed_for_time(const LineTask& task, UFloat ticks);

}  // namespace lamplock::motion
