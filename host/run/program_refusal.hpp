// What `lamplock send` refuses in a program before it sends anything, with the place in the file.
//
// In:  the text of a file and the lines that are sent. Out: an Error, or nothing.
// Who: `send`, of programs and of commands that users add; `check`, for the same places.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/error.hpp"
#include "host/link/program_lines.hpp"
#include "host/program/program_run.hpp"

namespace lamplock::run {

/// A program as it is sent.
struct ProgramText {
  std::string file;
  std::string source;  ///< text of the file
  std::vector<link::ProgramLine> lines;
};

/// Throws Error(bad_input) at the first `$` line that the board may refuse while a program runs.
/// A file of `$` lines alone is no program.
void check_board_lines(const ProgramText& program);

/// Throws Error(bad_input) at the first `$SLP`, after which the machine does not answer.
void refuse_sleep(const ProgramText& program);

/// The problem of a line that is sent, with the line and the column of the program's file; the
/// place in another file is in the text. The column is 0 if it is not known. A user command,
/// which was replaced by a pause, has its own name.
program_run::Problem in_file(const ProgramText& program, program_run::Problem problem);

/// An error about a line of the file `input` as a problem of this line; nothing of other errors.
/// The place in a file that the program calls is in its text.
std::optional<program_run::Problem> problem_of(const Error& error, const std::string& input);

/// The error for a problem in one of the lines, with the text of `lamplock check`. Its place is
/// FILE:LINE:COLUMN; without the column if it is not known or the line differs from the file's.
Error refusal_of(const ProgramText& program, const program_run::Problem& problem);

}  // namespace lamplock::run
