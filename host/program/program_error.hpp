// An error in a line of a program, with its place for scripts.
//
// In:  the place, the number of the machine's error, texts. Out: the error, as one line and in
//      parts. Who: program_flow.cpp and process_values.cpp throw it; `check --json` reports its
//      parts.
#pragma once

#include <cstddef>
#include <string>

#include "host/error.hpp"

namespace lamplock::program_run {

/// Where in a file an error is.
struct ProgramPlace {
  std::string file{};
  std::size_t line = 0;    ///< from 1
  std::size_t column = 0;  ///< from 1; 0: not known
};

/// FILE:LINE:COLUMN, without what is 0.
std::string text_of(const ProgramPlace& place);

/// Its status is that of bad input.
class ProgramError : public Error {
 public:
  /// `number`: of the machine's error; 0 if the machine has none for it.
  ProgramError(ProgramPlace place, const std::string& what, const std::string& remedy,
               int number = 0);
  /// Of a file that a line of the program calls: the same message.
  ProgramError(const Error& cause, std::string file);

  /// In the file that has the error.
  const ProgramPlace& place() const { return place_; }
  int number() const { return number_; }
  /// What is wrong, and the remedy; the whole message, and none, of another error.
  const std::string& text() const { return text_; }
  const std::string& remedy() const { return remedy_; }

  /// The line of the program that was executed: that of the call if its file has the error.
  std::size_t program_line() const { return program_line_ == 0 ? place_.line : program_line_; }
  void set_program_line(std::size_t line) { program_line_ = line; }

 private:
  ProgramPlace place_;
  int number_ = 0;
  std::string text_, remedy_;
  std::size_t program_line_ = 0;
};

}  // namespace lamplock::program_run
