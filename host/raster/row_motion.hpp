// Motion of rows: the distance to reach their feed, and their duration.
//
// In:  settings, a feed; a job of rows. Out: a distance, a time, by the firmware's line planner.
// Who: `lamplock raster` and `send`.
#pragma once

#include <cstdint>
#include <vector>

#include "host/job/job.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::raster {

/// Distance along X from rest to a feed. Throws Error(bad_input) for a machine that cannot move.
double run_up_mm(const settings::Values& values, double feed_mm_min);

/// Duration of a job that begins at machine zero, planned to the tick by the firmware's planner.
/// Delays by a full run table of the board are not included.
double seconds_of(const job::Job& job);

/// The time at the end of each line [s], as seconds_of(), at this job speed in percent.
std::vector<double> line_ends_s(const job::Job& job, std::uint32_t job_speed);

}  // namespace lamplock::raster
