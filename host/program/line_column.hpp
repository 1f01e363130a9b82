// Columns of a line as it is in its file, for errors in the line that the host has executed:
// without comments, with numbers in place of values, an O-word without blanks.
//
// In:  a line that is executed, a column of it. Out: the column in the file.
// Who: `check` and `send`, for errors of lines that the host has executed.
#pragma once

#include <cstddef>
#include <string_view>

#include "host/link/program_lines.hpp"

namespace lamplock::program_run {

/// The column in the file of the word at this column of line.text, both from 1. 0 if it is not
/// known: `line.source` is not a line with the same words.
std::size_t column_in_file(const link::ProgramLine& line, std::size_t column);

/// The column in the file of this column of the text of a line that is as its file has it but for
/// comments and blanks at its ends. 0 for 0.
std::size_t column_of_statement(const link::ProgramLine& line, std::size_t column);

/// The column of the character with this index among those that are no blanks, in a line without
/// comments; from 1. 0 if there are fewer.
std::size_t column_without_blanks(std::string_view line, std::size_t index);

}  // namespace lamplock::program_run
