// Describes errors of words that the machine has, but that the state of the program excludes.
//
// In:  a line with its fault, the interpreter in its state before the line. Out: a text and a
//      remedy, or nothing. Who: describe_fault().
#pragma once

#include <optional>
#include <string_view>

#include "firmware/program/interpreter.hpp"
#include "host/program/line_fault.hpp"

namespace lamplock::program_run {

/// For the errors unsupported and bad_target. `word`: at fault, within `line`.
std::optional<LineFault> describe_state_fault(std::string_view line, std::string_view word,
                                              GcodeError error,
                                              const program::Interpreter& interpreter);

}  // namespace lamplock::program_run
