// Run-ups: rows of points where it pays to accelerate before their first point.
//
// In:  a window that has been set up (window.hpp), the points known after it.
// Out: at the first point of such a row only those speeds are allowed from which every way of the
//      row takes the fewest beats.
// Who: the planner, once per window; some hundred cycles per point searched.
//
// A machine that accelerates along an even row of spacing d (in units of A x beat^2) gets from k +
// 1 beats a way to k only if d <= k (k + 1) (k + 1/2): the speed must rise by d/k - d/(k + 1)
// within about k + 1/2 beats, and no faster way is between. So it stays at the first k with that
// bound, although the speed limit and the even spacing would permit fewer. Starting further back it
// can have any speed at the first point; from rest that costs (1 + sqrt 2) v beats, away and back.
// Whether the row is long enough for that is decided by a search of `run_horizon` points ahead,
// inside the window or not.
#pragma once

#include <cstdint>

#include "firmware/motion/plan_request.hpp"
#include "firmware/motion/profile/window.hpp"

namespace lamplock::motion {

/// Narrows the allowed speeds at the first points of rows in the window; true if there is one.
bool allow_run_ups(const PlanRequest& request, Window& window);

/// Beats per way if the whole window is one row with equal ways and the machine runs along it
/// already: then no search is needed, the speed stays. 0 if not.
std::int32_t steady_beats(const Window& window, const PerAxis<std::int32_t>& start_qs);

}  // namespace lamplock::motion
