// Words of a G-code line, for code that changes a program without running it.
//
// In:  a line without comments (host/link/program_lines.hpp). Out: its words, unchanged.
// Who: without_laser(), start_at().
#pragma once

#include <cctype>
#include <optional>
#include <string_view>
#include <vector>

#include "host/text.hpp"

namespace lamplock::program_run {

struct ProgramWord {
  char letter = 0;        ///< upper case
  std::string_view text;  ///< with its letter, up to the next word: a list of powers is one word

  /// Its number; empty if it has none, or more than one.
  std::optional<double> number() const { return number_of<double>(trimmed(text.substr(1))); }
  bool is(char of, double value) const { return letter == of && number() == value; }
};

inline std::vector<ProgramWord> words_of(std::string_view line) {
  const auto is_letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
  std::vector<ProgramWord> words;
  for (std::size_t i = 0; i < line.size();) {
    std::size_t end = i + 1;
    while (end < line.size() && !is_letter(line[end])) ++end;
    if (is_letter(line[i]))
      words.push_back({static_cast<char>(std::toupper(static_cast<unsigned char>(line[i]))),
                       line.substr(i, end - i)});
    i = end;
  }
  return words;
}

}  // namespace lamplock::program_run
