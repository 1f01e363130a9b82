// Jobs need this firmware: a board of grbl takes programs alone, and never answers a job.
//
// In:  an open board. Out: nothing, or an error that says what to do. Who: commands that send jobs,
//      before anything else is said to the board.
#pragma once

#include <string>

#include "host/link/transport.hpp"

namespace lamplock::cli {

/// Throws Error(bad_input) if the board says that it is grbl without lamplock. One that says
/// nothing in half a second, as one in the middle of a job may, is left to the sender.
void require_lamplock(link::Transport& board, const std::string& name);

}  // namespace lamplock::cli
