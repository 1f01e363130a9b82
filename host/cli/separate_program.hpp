// Commands that are programs of their own, so that not every build of lamplock compiles them.
//
// In:  a command with the name of its program, the arguments. Out: that program in place of this
// one. Who: the parser.
#pragma once

#include <string>
#include <vector>

#include "host/cli/command_line.hpp"

namespace lamplock::cli {

/// The command's program is beside this one.
bool has_separate_program(const Command& command);

/// Replaces this process by the command's program, found beside this one. `arguments`: those of
/// this program, the command's name first; the program gets all of them. Throws Error(bad_input) if
/// there is no such program.
[[noreturn]] void run_separate_program(const Command& command,
                                       const std::vector<std::string>& arguments);

}  // namespace lamplock::cli
