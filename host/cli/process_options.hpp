// The options of programs that the host serves: a material, user commands.
//
// In:  a command. Out: its options; the choices. Who: `check`, `send`.
#pragma once

#include <string>

#include "host/cli/command_line.hpp"
#include "host/run/process_choice.hpp"

namespace lamplock::cli {

/// --material and what belongs to it, in a group of their own.
void add_process(Command& app, run::ProcessChoice& choice);
/// --user-commands.
void add_user_commands(Command& app, std::string& folder);

}  // namespace lamplock::cli
