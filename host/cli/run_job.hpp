// Runs a job on a board: what `engrave`, `send` and `frame` share.
//
// In:  a job and the points it was made of; where to run it. Out: how it went; the report.
// Ctrl-C once holds the machine, Enter goes on, Ctrl-C again stops. Where a job that did not end
// well can go on is always told.
#pragma once

#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "host/cli/console.hpp"
#include "host/cli/options.hpp"
#include "host/error.hpp"
#include "host/job/job.hpp"
#include "host/link/sender.hpp"
#include "host/link/transport.hpp"
#include "host/points/point.hpp"
#include "host/report/report.hpp"

namespace lamplock::cli {

/// A job and what it is about.
struct Work {
  std::string input;          ///< file
  points::PointCloud points;  ///< as ordered, one per target that is no pause; none of rows
  job::Job job;
  std::vector<std::string> warnings{};  ///< about the points
};

/// What came of it: `run` is what a report is made of; empty for rows.
struct Outcome {
  link::JobResult result;
  report::JobRun run;
  /// Why it ended before its end, if an error was the reason: part of the job was done before.
  std::exception_ptr error{};
  std::string ended_by{};  ///< the line of the computer that stopped it; empty if none did
};

/// Opens a real board (board_port.hpp); nothing for simulated ones. Throws Error: no_device,
/// bad_input.
std::unique_ptr<link::Transport> open_port(const BoardOptions& options);

/// With --fired: the first point wants fewer flashes than it did. Throws Error(bad_input).
void take_off_fired(Work& work, const BoardOptions& options);

/// Asks the user if need be, then runs the job to its end. `port` as open_port() gave it. Throws
/// Error where nothing was done; later errors are part of the outcome.
Outcome run_job(const Work& work, const BoardOptions& options,
                std::unique_ptr<link::Transport> port, Console& console);

/// Judges the run, prints and writes the report, and tells how to go on. Gives the exit status.
Exit report_job(const Outcome& outcome, const BoardOptions& options, Console& console);

/// One line on stderr if the job did not end well; gives the exit status. `item`: Job::item().
/// Throws Error for what is more than a stop of the user.
Exit tell_end(const Outcome& outcome, const BoardOptions& options, const char* item);

/// How a job ended, for programs; "failed": by an error.
std::string end_name(const Outcome& outcome);

}  // namespace lamplock::cli
