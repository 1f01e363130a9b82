// Runs a job on a board: what `engrave`, `send`, `frame` and `operate pulse` share.
//
// In:  a job and the points it was made of; where to run it. Out: how it went (job_outcome.hpp).
// Ctrl-C once holds the machine, Enter resumes, Ctrl-C again stops.
#pragma once

#include <memory>

#include "host/run/board_options.hpp"
#include "host/run/frontend.hpp"
#include "host/run/job_outcome.hpp"
#include "host/run/prepared_job.hpp"

namespace lamplock::link {
class KeptJob;
class Transport;
}  // namespace lamplock::link

namespace lamplock::run {

/// Asks the user if need be, then runs the job to its end. `port` as open_port() gave it
/// (board_port.hpp). `kept`: where its progress is written, from keep_progress(); null = nowhere.
/// Throws Error where nothing was done; later errors are part of the outcome.
JobOutcome run_job(const PreparedJob& prepared, const BoardOptions& options,
                   std::unique_ptr<link::Transport> port, Frontend& frontend,
                   link::KeptJob* kept = nullptr);

}  // namespace lamplock::run
