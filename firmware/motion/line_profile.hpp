// How the machine runs along a line, or the next piece of it.
//
// In:  what is left of the line, the speed it starts with, the speeds planned for it and its end.
// Out: a run of up to three phases, each a whole number of ticks: to the end of the line if that
//      is no more than a slice away, or else a slice of it.
// Called by the line planner, once per segment.
//
// The phases of the textbook, up to a speed, along, and down, do not last whole ticks. Within a
// line that does not matter: a slice ends earlier, and what is left is planned again. The run to
// the end of a line has to be exact. Each phase is rounded up; over these ticks the planned speeds
// lead a little too far, by less than two ticks' way:
//   * where there is a phase above both ends the speed in the middle is lowered, and the ends are
//     as planned;
//   * or else all speeds of the run are lowered in proportion. So at the joints of a path of very
//     short lines, n ticks each, the speed may jump by up to 4/n of itself, which is the way of a
//     few ticks: nothing ever is further than that from where it would be without rounding.
// Both only lower speeds and accelerations, so limits are kept. A run whose time comes out whole
// anyway is not slowed at all.
#pragma once

#include <cstdint>

#include "firmware/motion/line_real.hpp"
#include "firmware/motion/line_rise.hpp"

namespace lamplock::motion {

/// What is to be done.
struct LineTask {
  LineReal length;  ///< to the end of the line, > 0
  LineReal start;   ///< speed now
  LineReal end;     ///< planned for the end of the line
  LineReal speed;   ///< to run at
  LineReal accel;
  const LineRise* rise = nullptr;  ///< of the acceleration
  bool stop = false;               ///< stop as soon as possible
  std::uint32_t slice_ticks = 0;
};

/// What is done. Speeds are those at the ends of phases.
struct LineRun {
  LineReal start, cruise, end;
  std::uint32_t lead_ticks = 0, cruise_ticks = 0, tail_ticks = 0;
  bool whole = false;  ///< leads to the end of the line, exactly
  LineReal next;       ///< speed planned for what follows; `end` but for rounding

  std::uint32_t ticks() const { return lead_ticks + cruise_ticks + tail_ticks; }
};

/// A run of no ticks if it is to stop and stands.
LineRun make_run(const LineTask& task);

/// Speed at which the rest of a line takes `ticks`, ends and acceleration as in `task`; that of
/// the task if there is none.
LineReal speed_for_time(const LineTask& task, LineReal ticks);

}  // namespace lamplock::motion
