// Engraves: from a request to shots on a board.
//
// In:  a request, where to run it. Out: the outcome. Who: `engrave`.
#pragma once

#include "host/run/board_options.hpp"
#include "host/run/frontend.hpp"
#include "host/run/job_outcome.hpp"
#include "host/run/prepare_job.hpp"

namespace lamplock::run {

/// Prepares the job and runs it to its end. Throws Error where nothing was done.
JobOutcome engrave(const JobRequest& request, BoardOptions& options, Frontend& frontend);

}  // namespace lamplock::run
