// What a report is made of, as far as the job itself decides it.
//
// In:  a job with its points, where in it the run begins; how it ended. Out: a JobRun.
// Who: run_job, for what was run, and `estimate`, for what is foreseen.
#pragma once

#include <cstddef>
#include <string>

#include "host/geometry/point.hpp"
#include "host/report/report.hpp"
#include "host/run/board_options.hpp"
#include "host/run/job_outcome.hpp"
#include "host/run/prepared_job.hpp"

namespace lamplock::run {

/// The run of a job of points on `board`, by its name in the report, from number `from` on
/// (from <= size of the job): the report is about the rest of the job. `points`: those of the rest;
/// the caller's last copy if it can be, of ten million there is hardly room for two.
report::JobRun begin_run(const PreparedJob& prepared, geometry::PointCloud points,
                         const std::string& board, std::size_t from);

/// The run by the counters of a board, and where it ended.
report::JobRun run_on_board(const PreparedJob& prepared, const BoardOptions& options,
                            const JobOutcome& outcome);

}  // namespace lamplock::run
