// How a job ended: its report, and the error or advice that follows from the end.
//
// In:  the outcome of a run. Out: the report as text and files; the exit status, or an Error.
// Who: run_job(), which writes the numbers at once, and the commands that run jobs.
//
// The exit status follows from the phase: once the machine has begun to fire, neither an error nor
// a file that cannot be written gives bad_input or no_device, which mean that nothing was done.
#pragma once

#include "host/error.hpp"
#include "host/report/report.hpp"
#include "host/run/board_options.hpp"
#include "host/run/frontend.hpp"
#include "host/run/job_outcome.hpp"

namespace lamplock::run {

/// Evaluates the run; writes report.json and the line of statistics if they were requested, before
/// anything that takes longer. What cannot be written is lost (JobOutcome::lost).
void write_numbers(JobOutcome& outcome, const BoardOptions& options);

/// Shows the report and writes the other files of its folder.
void report_job(JobOutcome& outcome, const BoardOptions& options, Frontend& frontend);

/// Exit status of a job, with a notice if the user has stopped it, and for each file that is lost.
/// `item`: Job::item(). Throws Error for every other end before the last item.
Exit judge_end(const JobOutcome& outcome, const BoardOptions& options, const char* item,
               Frontend& frontend);

/// The same of a job of points; also throws Error(job_failed) if points were missed or fired too
/// often.
Exit judge_points(const JobOutcome& outcome, const BoardOptions& options, Frontend& frontend);

}  // namespace lamplock::run
