// User commands: M100 to M199, programs of the user that the host runs.
//
// In:  a line without comments. Out: its command with the numbers of P and Q, as LinuxCNC has them
//      ("M Codes", M100 to M199). Who: `check` and `send` with --user-commands.
//
// The codes that the machine has itself stay its own: M117, M126 to M128, M130, M131.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "host/link/program_lines.hpp"

namespace lamplock::program_run {

struct UserCommand {
  int number = 0;         ///< 100 to 199
  double p = -1, q = -1;  ///< -1: not given
  /// "M101"
  std::string name() const;
};

/// Whether a line has a user command.
bool is_user_command(std::string_view line);

/// The command of a line; empty if it has none. Throws ProgramError for other words in its line,
/// for words that occur twice and for values that are no numbers of a program. `file`: of the
/// program, for errors.
std::optional<UserCommand> user_command_of(const link::ProgramLine& line, const std::string& file);

/// A program in which a pause, at which the machine is at rest as well, takes the place of each
/// user command.
std::string without_user_commands(std::string_view program);

/// The line that replaces a user command.
inline constexpr std::string_view stand_in = "M60";

}  // namespace lamplock::program_run
