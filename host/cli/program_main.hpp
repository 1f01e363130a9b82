// What the main functions of lamplock, lamplock-chip and lamplock-bench share.
//
// In:  the commands, the arguments of main. Out: the exit status; errors as one line on stderr.
#pragma once

#include "host/cli/command_line.hpp"

namespace lamplock::cli {

/// Parses and runs. Ctrl-C ends the program unless a command handles it.
int program_main(Command& program, int argc, char** argv);

}  // namespace lamplock::cli
