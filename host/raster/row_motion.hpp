// How a machine runs rows: the way that it needs to their feed, and the time that they take.
//
// In:  settings, a feed; a job of rows. Out: a way, a time, as the firmware's line planner has
// them. Who: `lamplock raster` and `send`.
#pragma once

#include "host/job/job.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::raster {

/// Way along X from rest to a feed. Throws Error(bad_input) for a machine that cannot move.
double run_up_mm(const settings::Values& values, double feed_mm_min);

/// How long a job takes from machine zero on, planned to the tick by the firmware's planner. That
/// the board's table of runs holds it up is left out.
double seconds_of(const job::Job& job);

}  // namespace lamplock::raster
