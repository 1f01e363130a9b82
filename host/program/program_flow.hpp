// Runs the O-words of a program: subs, branches and loops become the lines that a board gets.
//
// In:  the lines of a program; subs that it does not have are files NAME.ngc in its folder. The
//      settings of the machine, its state if it is known.
// Out: the lines in the order in which they are executed, values as numbers, each with the number
//      of its line in the file; a line of another file has that of the call. M2 and M30 end them.
// Who: `check` and `send`, before they run or send the lines.
//
// As in LinuxCNC: parameters #1 to #30 and names without underscore belong to the call of a sub;
// endsub [value] and return [value] set #<_value>. M98 P L and M99 share all parameters with the
// caller. Values that only the machine finds out - the result of a probe or of M66 - are not known
// here: programs that use them are refused.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/link/program_lines.hpp"
#include "host/program/board_state.hpp"
#include "host/program/process_values.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::program_run {

/// Calls in calls; arguments of one.
inline constexpr std::size_t max_calls = 10, max_arguments = 30;
/// A program with more lines does not end, or is too long to keep; so many statements without a
/// line do not end either.
inline constexpr std::size_t max_flow_lines = 1'000'000, max_flow_steps = 1'000'000;

/// `process`: of the chosen material, null without one. Throws ProgramError for every error in an
/// O-word or a value.
std::vector<link::ProgramLine> run_flow(std::vector<link::ProgramLine> lines,
                                        const std::string& file, const settings::Values& values,
                                        const std::optional<BoardState>& state = {},
                                        const ProcessValues* process = nullptr);

}  // namespace lamplock::program_run
