// The files that a command line names, looked at together before the command begins.
//
// In:  a command whose options have their values. Out: nothing, or an Error. Who: the parser, for
//      every command: an output must not replace an input or another output.
#pragma once

namespace lamplock::cli {

class Command;

/// Throws Error(bad_input) if an output of the command is one of its inputs or another output.
void check_files(const Command& command);

}  // namespace lamplock::cli
