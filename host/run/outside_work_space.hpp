// The error of a machine that is outside its work space: no job can begin there.
//
// In:  a board that has refused a job. Out: the error, with the way into the work space. Who:
// run_job().
#pragma once

#include "host/link/transport.hpp"
#include "host/run/board_options.hpp"

namespace lamplock::run {

/// Throws Error(bad_input) if the board reports a position outside its work space. Does nothing if
/// the board does not report both.
void require_inside_work_space(link::Transport& board, const BoardOptions& options);

}  // namespace lamplock::run
