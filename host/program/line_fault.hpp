// Describes why the machine refuses a line of a program: the word at fault, and what to do.
//
// In:  a line, the fault of the interpreter with its column. Out: a text and a remedy.
// Who: program_run.cpp, for `lamplock check` and `lamplock send`. The machine itself reports only a
// number; the host has the line.
#pragma once

#include <string>
#include <string_view>

#include "firmware/program/interpreter.hpp"

namespace lamplock::program_run {

struct LineFault {
  std::string text;
  std::string remedy{};  ///< empty: none but to correct the line
};

/// Names the word at fault, or the words that are missing; otherwise the text of the number of the
/// error. `axes`: of the machine, named by axis_letters. `interpreter`: in its state before the
/// line; null if it is not known.
LineFault describe_fault(std::string_view line, const program::Fault& fault, int axes,
                         const program::Interpreter* interpreter);

}  // namespace lamplock::program_run
