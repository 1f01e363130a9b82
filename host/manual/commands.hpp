// The command line as its manual sees it: commands, options, what an option takes.
//
// In:  a command. Out: what is to be described, in the order in which it was added; what is hidden
//      (an empty group) left out.
// Who: man pages and completions.
#pragma once

#include <string>
#include <vector>

#include "host/cli/command_line.hpp"

namespace lamplock::manual {

/// The options of a command without positionals.
std::vector<const cli::Option*> options_of(const cli::Command& command);

/// Its positionals.
std::vector<const cli::Option*> positionals_of(const cli::Command& command);

/// "FILE", "free|path|start-stop"; empty for flags.
std::string argument_of(const cli::Option& option);

/// Words that an option takes as they are: "free", "path", "start-stop" of "free|path|start-stop".
/// What is written in capitals stands for something else.
std::vector<std::string> words_of(const cli::Option& option);

/// A part of its argument is the name of a file or folder.
bool takes_file(const cli::Option& option);
/// A part of its argument is a serial port.
bool takes_port(const cli::Option& option);

}  // namespace lamplock::manual
