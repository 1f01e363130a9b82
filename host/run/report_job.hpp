// How a job ended: its report, and the error or advice that follows from the end.
//
// In:  the outcome of a run. Out: the report as text and files; the exit status, or an Error.
// Who: the use cases that run jobs, after run_job().
#pragma once

#include "host/error.hpp"
#include "host/report/report.hpp"
#include "host/run/board_options.hpp"
#include "host/run/frontend.hpp"
#include "host/run/job_outcome.hpp"

namespace lamplock::run {

/// Evaluates the run, shows the report, writes its folder and its line of statistics if they were
/// requested. Throws Error if they cannot be written.
report::Report report_job(const JobOutcome& outcome, const BoardOptions& options,
                          Frontend& frontend);

/// Exit status of a job, with a notice if the user has stopped it. `item`: Job::item(). Throws
/// Error for every other end before the last item.
Exit judge_end(const JobOutcome& outcome, const BoardOptions& options, const char* item,
               Frontend& frontend);

/// The same of a job of points; also throws Error(job_failed) if points were missed or fired too
/// often.
Exit judge_points(const JobOutcome& outcome, const report::Report& report,
                  const BoardOptions& options, Frontend& frontend);

}  // namespace lamplock::run
