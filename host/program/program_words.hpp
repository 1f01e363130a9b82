// Words of a G-code line, for code that changes a program without running it.
//
// In:  a line without comments (host/link/program_lines.hpp). Out: its words, unchanged; the
// letters in an expression, in a name or of a function are no words, an assignment is one with the
// letter #. Who: without_laser(), start_at().
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/text.hpp"

namespace lamplock::program_run {

struct ProgramWord {
  char letter = 0;        ///< upper case; # of an assignment
  std::string_view text;  ///< with its letter, up to the next word: a list of powers is one word

  /// Its number; empty if it has none, or more than one.
  std::optional<double> number() const { return number_of<double>(trimmed(text.substr(1))); }
  bool is(char of, double value) const { return letter == of && number() == value; }
};

/// The words of a line: from a letter, or the # of an assignment, to the next one.
std::vector<ProgramWord> words_of(std::string_view line);

/// The line without the words that are this code, M99, and without blanks at both ends.
std::string without_code(std::string_view line, char letter, double number);

}  // namespace lamplock::program_run
