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

/// Names the word for error 20 (unsupported), 1 (no letter) and 2 (no number); the others have the
/// text of their number. `axes`: of the machine, named by axis_letters.
LineFault describe_fault(std::string_view line, const program::Fault& fault, int axes);

}  // namespace lamplock::program_run
