// A dialogue by lines between a user, or a script, and a board.
//
// In:  a board, lines of the frontend. Out: the answers of the board, line by line.
// Who: `console`.
#pragma once

#include <string_view>

#include "host/run/frontend.hpp"
#include "host/run/supervised_board.hpp"

namespace lamplock::run {

/// Sends the lines that the frontend gives until they end. Typed lines: a wrong word is reported,
/// and the session continues. Lines of a file or a pipe: each is sent after the answer to the line
/// before; the first error or alarm, and a hold at the end that no line asked for, is thrown as
/// Error(job_failed). Throws Error.
void run_console(const BoardChoice& choice, Frontend& frontend);

/// A character that is added to the begin of a line is text of a comment, not a real-time command.
bool is_in_comment(std::string_view begin);

}  // namespace lamplock::run
