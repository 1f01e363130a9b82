// Run-ups: rows of points that pay for getting up to speed before their first one.
//
// In:  a window that has been set up (way.hpp), the points known behind it.
// Out: at the first point of such a row only those speeds are allowed from which every way of the
//      row takes the fewest beats.
// Called by the planner, once per window; some hundred cycles per point looked at.
//
// A machine that climbs along an even row of spacing d (in units of A x beat^2) gets from k + 1
// beats a way to k only if d <= k (k + 1) (k + 1/2): the speed has to rise by d/k - d/(k + 1)
// within about k + 1/2 beats, and no faster way lies between. So it stays at the first k with that
// bound, although speed and evenness would permit fewer. Coming from further back it can have any
// speed at the first point; from rest that costs (1 + sqrt 2) v beats, back and forth again.
// Whether the row is long enough for that is seen by looking `run_horizon` points ahead, whether or
// not they belong to the window.
#pragma once

#include <cstdint>

#include "firmware/motion/plan_request.hpp"
#include "firmware/motion/way.hpp"

namespace lamplock::motion {

/// Narrows what is allowed at the first points of rows in the window; true if there is one.
bool allow_run_ups(const PlanRequest& request, Window& window);

/// Beats per way if the window is all of one row, its ways equal to the step, and the machine runs
/// through it already: then nothing has to be searched, the speed stays. 0 if not.
std::int32_t steady_beats(const Window& window, const PerAxis<std::int32_t>& start_qs);

}  // namespace lamplock::motion
