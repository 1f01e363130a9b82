// What each argument of a command line is: a command, an option, its value, a file.
//
// In:  the commands as data, the arguments of main. Out: the arguments in their order, each with
//      the command and the option that it belongs to; unknown ones are marked.
// Who: the help (which command is it for?) and the messages about wrong usage. The values are
//      converted by the parser (parser.hpp), which has the same rules.
#pragma once

#include <string>
#include <vector>

#include "host/cli/command_line.hpp"

namespace lamplock::cli {

enum class ArgumentKind {
  command,
  option,
  value,  ///< of the option before it
  positional,
  unknown_command,  ///< the command needs a command, and this is none of them
  unknown_option,
  surplus  ///< one positional too many
};

struct Argument {
  ArgumentKind kind = ArgumentKind::positional;
  std::string text;                  ///< as typed; of an option without "=VALUE"
  const Command* command = nullptr;  ///< the innermost one so far; of a command itself
  const Option* option = nullptr;    ///< of options, values and positionals
};

/// All arguments, with "--name=VALUE" as two.
std::vector<Argument> understood(const Command& program, const std::vector<std::string>& arguments);

/// The option of a command with this typed name, with -h and --version; null if there is none.
const Option* find_option(const Command& command, const std::string& name);

/// A word that must be followed by its value.
bool takes_value(const Option& option);

/// "lamplock settings get" of the commands up to an argument.
std::string path_of(const Command& program, const std::vector<Argument>& arguments,
                    std::size_t count);

}  // namespace lamplock::cli
