// `$` lines of a program: which of them a machine may get while the program runs.
//
// In:  a line without comments (host/link/program_lines.hpp). Out: whether it may be sent.
// Who: `lamplock check` and `lamplock send`, so that both decide the same.
#pragma once

#include <string>
#include <string_view>

namespace lamplock::program_run {

bool is_board_line(std::string_view line);

/// Why a `$` line must not be in a program that moves: it changes settings, jogs, or switches a
/// mode. Empty for homing, unlocking, questions, and for lines that are not `$` lines.
std::string board_line_fault(std::string_view line);

/// True for `$SLP`: a machine that sleeps does not answer, so that no sender comes to an end. It
/// must not even be in a file of `$` lines.
bool is_sleep(std::string_view line);

/// No line of the text is G-code, but some are `$` lines: no program.
bool has_only_board_lines(std::string_view text);

}  // namespace lamplock::program_run
