// Parses the command line with CLI11, which is included nowhere else: it takes ten seconds to
// compile.
//
// In:  the commands as data (command_line.hpp), the arguments of main. Out: values in the places
//      that the options name, then what the command returns.
// Who: the programs' main functions.
#pragma once

#include <string>
#include <vector>

#include "host/cli/command_line.hpp"

namespace lamplock::cli {

/// Parses the arguments that follow the program's name, former names of options included
/// (host/former_names.hpp), then runs the command that they name;
/// prints the help or the version if that is what they ask for. Throws Error(bad_input) for
/// arguments that cannot be understood, and what the command throws.
Exit run(Command& program, const std::vector<std::string>& arguments);

}  // namespace lamplock::cli
