// Motion of rows: the distance to reach their feed, and their duration.
//
// In:  settings, a feed; a job of rows. Out: a distance, a time, by the firmware's line planner.
// Who: `lamplock raster` and `send`.
#pragma once

#include <cstdint>
#include <vector>

#include "host/job/job.hpp"
#include "shared/settings_table.hpp"
#include "shared/wire/job_header.hpp"

namespace lamplock::raster {

/// Distance along X from rest to a feed. Throws Error(bad_input) for a machine that cannot move.
double run_up_mm(const settings::Values& values, double feed_mm_min);

/// The time at the end of each line [s] of a job that begins at machine zero, at this job speed in
/// percent, planned to the tick by the firmware's planner. Delays by a full run table of the board
/// are not included.
std::vector<double> line_ends_s(const job::Job& job, std::uint32_t job_speed);

/// Duration [s] of the lines from `first` on, by line_ends_s(); 0 if there are none.
double seconds_of(const job::Job& job, std::uint32_t job_speed = wire::full_job_speed,
                  std::size_t first = 0);

}  // namespace lamplock::raster
