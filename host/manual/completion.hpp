// Completion for shells from the command line itself.
//
// In:  the application. Out: scripts for bash and fish. They know commands, options, the words that
//      options take, and where a file or a port belongs.
// Who: lamplock_manual, while the program is built.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace lamplock::manual {

/// To be put where bash-completion looks, under the name of the program.
std::string bash_completion(const CLI::App& program);

/// To be put into fish's vendor_completions.d as lamplock.fish.
std::string fish_completion(const CLI::App& program);

}  // namespace lamplock::manual
