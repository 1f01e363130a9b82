// The permission that a real laser or machine needs before its first shot or move.
//
// In:  what will happen, on which board. Out: nothing, or an error: nothing was done.
// Who: run_job(), run_program(), before they send anything.
#pragma once

#include <string>

#include "host/run/board_options.hpp"
#include "host/run/frontend.hpp"

namespace lamplock::run {

/// Refuses before any work what needs a permission that no user can give. Throws Error(bad_input),
/// or no_device if the board is not connected either.
void require_askable(const BoardOptions& options, const Frontend& frontend);

/// Asks `question` unless --yes was given or the board is simulated. Throws Error(interrupted) with
/// `where` and `denied` ("nothing was fired") if the user does not confirm.
void require_permission(const BoardOptions& options, Frontend& frontend,
                        const std::string& question, const std::string& where,
                        const std::string& denied);

}  // namespace lamplock::run
