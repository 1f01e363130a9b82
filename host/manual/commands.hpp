// The command line as its manual sees it: commands, options, what an option takes.
//
// In:  an application with its commands. Out: what is to be described, in the order in which it was
//      added; what is hidden (an empty group) left out.
// Who: man pages and completions.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace lamplock::manual {

/// The commands of an application or of a command.
std::vector<const CLI::App*> commands_of(const CLI::App& app);

/// Its options without positionals.
std::vector<const CLI::Option*> options_of(const CLI::App& app);

/// Its positionals.
std::vector<const CLI::Option*> positionals_of(const CLI::App& app);

/// Names as they are typed: "-h", "--help".
std::vector<std::string> names_of(const CLI::Option& option);

/// "FILE", "free|path|start-stop"; empty for flags.
std::string argument_of(const CLI::Option& option);

/// Words that an option takes as they are: "free", "path", "start-stop" of "free|path|start-stop".
/// What is written in capitals stands for something else.
std::vector<std::string> words_of(const CLI::Option& option);

/// A part of its argument is the name of a file or folder.
bool takes_file(const CLI::Option& option);
/// A part of its argument is a serial port.
bool takes_port(const CLI::Option& option);

}  // namespace lamplock::manual
