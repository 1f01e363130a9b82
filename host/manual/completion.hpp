// Completion for shells from the command line itself.
//
// In:  the commands of the program. Out: scripts for bash and fish. They know commands, options,
// the words that
//      options take, and where a file or a port belongs.
// Who: lamplock_manual, while the program is built.
#pragma once

#include <string>

#include "host/cli/command_line.hpp"

namespace lamplock::manual {

/// To be put where bash-completion looks, under the name of the program.
std::string bash_completion(const cli::Command& program);

/// To be put into fish's vendor_completions.d as lamplock.fish.
std::string fish_completion(const cli::Command& program);

}  // namespace lamplock::manual
