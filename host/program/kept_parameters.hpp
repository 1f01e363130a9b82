// Parameters (#1, #<name>) and saved modes (M70, M73) that an earlier program or the console has
// left on a board, because no M2 followed: they would act in the next program, while the host
// computes with none.
//
// In:  the lines of a program, a board at rest. Out: `$RST=P` for the board.
// Who: `lamplock send`, before it sends a program.
#pragma once

#include <string>
#include <vector>

#include "host/link/line_port.hpp"
#include "host/link/program_lines.hpp"

namespace lamplock::program_run {

/// Asks the board to clear them, if the program may read a parameter or restore modes. Returns a
/// note if the board does not: it is busy or does not have the command. Throws Error(no_device) if
/// it does not answer.
std::string clear_kept_parameters(link::LinePort& port, const std::vector<link::ProgramLine>& lines,
                                  const std::string& file);

}  // namespace lamplock::program_run
