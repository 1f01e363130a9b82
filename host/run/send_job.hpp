// Sends a job file to a machine and sees it through.
//
// In:  a job file, where to run it. Out: the job as it was run, and its outcome.
// Who: `send`.
#pragma once

#include <string>

#include "host/run/board_options.hpp"
#include "host/run/frontend.hpp"
#include "host/run/job_outcome.hpp"
#include "host/run/prepared_job.hpp"

namespace lamplock::run {

/// A job file and its run.
struct SentJob {
  PreparedJob prepared;
  JobOutcome outcome;
  double planned_s = 0;  ///< of the rows to be run, at the job speed; 0 of points
};

/// Runs a job of points or rows; `options` get the point or line where it begins with --resume.
/// Throws Error where nothing was done.
SentJob send_job(const std::string& file, BoardOptions& options, Frontend& frontend);

}  // namespace lamplock::run
