// What came of a job on a board.
//
// In:  the run (run_job.hpp). Out: reports and exit statuses (report_job.hpp), documents of
// commands.
#pragma once

#include <exception>
#include <string>

#include "host/link/job_result.hpp"
#include "host/report/report.hpp"

namespace lamplock::run {

/// `run` is what a report is made of; empty for rows.
struct JobOutcome {
  link::JobResult result;
  report::JobRun run;
  /// Why it ended before its end, if an error was the reason: part of the job was done before.
  std::exception_ptr error{};
  bool is_kept = false;    ///< its progress is in a journal: --resume continues it
  std::string ended_by{};  ///< the line of the computer that stopped it; empty if none did
};

/// How a job ended, for programs; "failed": by an error.
std::string end_name(const JobOutcome& outcome);

}  // namespace lamplock::run
