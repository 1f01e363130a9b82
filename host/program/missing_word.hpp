// Names the words that a command needs and that a line does not have.
//
// In:  a line with error 28 (value_missing), the column of the command, the interpreter in its
//      state before the line. Out: a text that names the command and its missing words.
// Who: describe_fault(). The interpreter itself reports only the command.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "firmware/program/interpreter.hpp"

namespace lamplock::program_run {

/// "'G41.1' needs a D word (the diameter of the cutter)". Nothing if the command cannot be found:
/// its number may be an expression. `column` counts from 1; `interpreter` may be null: no cycle and
/// no spline is in force.
std::optional<std::string> missing_words(std::string_view line, std::size_t column,
                                         const program::Interpreter* interpreter);

}  // namespace lamplock::program_run
