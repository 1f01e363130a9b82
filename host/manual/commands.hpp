// The command line for its manual: commands, options, arguments of options.
//
// In:  a command. Out: its options and arguments, in the order in which they were added, without
//      hidden ones (with an empty group).
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

/// Literal words of an option: "free", "path", "start-stop" of "free|path|start-stop". Words in
/// capitals are placeholders.
std::vector<std::string> words_of(const cli::Option& option);

/// A part of its argument is the name of a file or folder.
bool takes_file(const cli::Option& option);
/// A part of its argument is a serial port.
bool takes_port(const cli::Option& option);

}  // namespace lamplock::manual
