// Runs a job on a board: what `engrave`, `send`, `frame` and `operate pulse` share.
//
// In:  a job and the points it was made of; where to run it. Out: how it went (outcome.hpp).
// Ctrl-C once holds the machine, Enter goes on, Ctrl-C again stops.
#pragma once

#include <memory>

#include "host/cli/options.hpp"
#include "host/cli/outcome.hpp"
#include "host/cli/work.hpp"
#include "host/link/kept_job.hpp"
#include "host/link/transport.hpp"

namespace lamplock::cli {

class Console;

/// Asks the user if need be, then runs the job to its end. `port` as open_port() gave it
/// (board_port.hpp). `kept`: where its progress is written, from keep_progress(); null = nowhere.
/// Throws Error where nothing was done; later errors are part of the outcome.
Outcome run_job(const Work& work, const BoardOptions& options,
                std::unique_ptr<link::Transport> port, Console& console,
                link::KeptJob* kept = nullptr);

}  // namespace lamplock::cli
