// The end of a command that has run a job of points: report, document, exit status.
#pragma once

#include "host/cli/console.hpp"
#include "host/error.hpp"
#include "host/run/board_options.hpp"
#include "host/run/job_outcome.hpp"

namespace lamplock::cli {

/// Throws Error for a job that did not end well.
Exit finish_job(run::JobOutcome& outcome, const run::BoardOptions& options, Console& console);

}  // namespace lamplock::cli
