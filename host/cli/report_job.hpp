// How a job ended, told and reported.
//
// In:  the outcome of a run. Out: the report on the console and in files, how to go on, the exit
//      status.
// Who: the commands that run jobs, behind run_job().
#pragma once

#include "host/cli/options.hpp"
#include "host/cli/outcome.hpp"
#include "host/error.hpp"

namespace lamplock::cli {

class Console;

/// Judges the run, prints and writes the report, and tells how to go on. Gives the exit status;
/// throws as tell_end(), and Error(job_failed) if points are missed or fired too often.
Exit report_job(const Outcome& outcome, const BoardOptions& options, Console& console);

/// One line on stderr if the job did not end well; gives the exit status. `item`: Job::item().
/// Throws Error for what is more than a stop of the user.
Exit tell_end(const Outcome& outcome, const BoardOptions& options, const char* item);

}  // namespace lamplock::cli
