// The help of a command.
//
// In:  a command as data, the width of the terminal. Out: text for stdout, wrapped.
// Who: the parser (-h, --help), the command `help`.
#pragma once

#include <cstddef>
#include <string>

#include "host/cli/command_line.hpp"

namespace lamplock::cli {

enum class HelpKind {
  common,  ///< -h: the common options of a command that has many
  all      ///< --help: all options, in their groups
};

/// `path`: "lamplock settings get". No line is longer than `width`, except for words that are.
std::string help_text(const Command& command, const std::string& path, HelpKind kind,
                      std::size_t width);

}  // namespace lamplock::cli
