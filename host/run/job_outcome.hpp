// What came of a job on a board.
//
// In:  the run (run_job.hpp). Out: reports and exit statuses (report_job.hpp), documents of
// commands. Who: the use cases that run jobs.
#pragma once

#include <exception>
#include <memory>
#include <string>

#include "host/link/job_result.hpp"
#include "host/link/not_ready.hpp"
#include "host/report/report.hpp"
#include "host/run/lost_files.hpp"

namespace lamplock::run {

class ReportFolder;

/// `run` is what `report` is made of; both are empty for rows.
struct JobOutcome {
  link::JobResult result;
  report::JobRun run;
  report::Report report;
  /// Of the report; its numbers are written, the rest is not. Null if no report was requested.
  std::shared_ptr<ReportFolder> folder{};
  LostFiles lost{};
  /// Why it ended before its end, if an error was the reason: part of the job was done before.
  std::exception_ptr error{};
  bool is_kept = false;    ///< its progress is in a journal: --resume continues it
  link::Homing homing{};   ///< of a real board, after an alarm
  std::string ended_by{};  ///< the line of the computer that stopped it; empty if none did
};

/// How a job ended, for programs; "failed": by an error.
std::string end_name(const JobOutcome& outcome);

}  // namespace lamplock::run
