// The options that choose a material for a program.
//
// In:  a command. Out: its options; the choice. Who: `check`, `send`.
#pragma once

#include "host/cli/command_line.hpp"
#include "host/run/process_choice.hpp"

namespace lamplock::cli {

/// --material and what belongs to it, in a group of their own.
void add_process(Command& app, run::ProcessChoice& choice);

}  // namespace lamplock::cli
