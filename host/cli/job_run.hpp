// What a report is made of, as far as the job itself decides it.
//
// In:  a job with its points, where in it the run begins. Out: a JobRun without what the machine
//      did. Who: run_job, for what was run, and `estimate`, for what is foreseen.
#pragma once

#include <cstddef>
#include <string>

#include "host/cli/run_job.hpp"
#include "host/report/report.hpp"

namespace lamplock::cli {

/// The run of a job of points on `board`, by its name in the report, from number `from` on
/// (from <= size of the job): the report is about the rest of the job. The points are taken over:
/// of ten million there is no room for two copies.
report::JobRun begin_run(Work work, const std::string& board, std::size_t from);

}  // namespace lamplock::cli
