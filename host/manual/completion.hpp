// Completion for shells, generated from the command line.
//
// In:  the commands of the program. Out: scripts for bash and fish, with commands, options,
//      their words, files and ports.
// Who: lamplock_manual, while the program is built.
#pragma once

#include <string>

#include "host/cli/command_line.hpp"

namespace lamplock::manual {

/// For the folder of bash-completion, as a file with the name of the program.
std::string bash_completion(const cli::Command& program);

/// For fish's vendor_completions.d, as lamplock.fish.
std::string fish_completion(const cli::Command& program);

}  // namespace lamplock::manual
