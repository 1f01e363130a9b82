// Jobs need this firmware: a board of grbl takes programs alone, and never answers a job.
//
// In:  a choice of a board. Out: the open port, or an error that says what to do.
// Who: commands that send jobs.
#pragma once

#include <memory>

#include "host/link/transport.hpp"
#include "host/run/board_options.hpp"

namespace lamplock::run {

/// As open_port(); throws Error(bad_input) as well if the board says that it is grbl without
/// lamplock. One that says nothing in half a second, as one in the middle of a job may, is left to
/// the sender.
std::unique_ptr<link::Transport> open_job_port(const BoardOptions& options);

}  // namespace lamplock::run
