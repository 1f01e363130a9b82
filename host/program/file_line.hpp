// A line of a program file as the interpreter reads it.
//
// In:  a line as it is in its file. Out: the fault of the interpreter, and columns in the file.
// Who: readers of whole programs (program_run.cpp, program_path.cpp).
//
// A board receives lines without comments, of at most wire::max_line characters, and its
// interpreter counts columns with 16 bits. Comments of a file may be of any length.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "firmware/program/interpreter.hpp"
#include "host/link/program_lines.hpp"
#include "shared/wire/framing.hpp"

namespace lamplock::program_run {

class FileLine {
 public:
  /// `line` must outlive the object.
  explicit FileLine(std::string_view line) : line_(line), is_whole_(line.size() <= wire::max_line) {
    if (is_whole_) return;
    kept_ = link::text_to_send(line);
    if (kept_.size() > wire::max_line) kept_.resize(wire::max_line + 1);
  }

  /// With its comments if the line is short enough for a board. Of a line that is too long even
  /// without them only one character more than a board takes.
  std::string_view text() const { return is_whole_ ? line_ : kept_; }

  /// Runs text(); a line that a board would not receive is a fault.
  program::Fault run(program::Interpreter& interpreter) const {
    if (text().size() <= wire::max_line) return interpreter.run(text());
    return {GcodeError::line_too_long, static_cast<std::uint16_t>(wire::max_line + 1)};
  }

  /// Where a column of text() is in the file, both from 1; 0 if it is not known.
  std::size_t column(std::size_t column) const {
    return is_whole_ ? column : link::column_in_line(line_, column);
  }

 private:
  std::string_view line_;
  bool is_whole_;
  std::string kept_;
};

}  // namespace lamplock::program_run
