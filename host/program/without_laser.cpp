#include "host/program/without_laser.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "host/error.hpp"
#include "host/program/program_words.hpp"

namespace lamplock::program_run {
namespace {

bool switches_on(const ProgramWord& word) {
  return word.letter == 'S' || word.is('M', 3) || word.is('M', 4);
}

/// Words that may release energy and cannot be removed, because later lines depend on them.
bool needs_laser(const ProgramWord& word) {
  constexpr double first_output = 62, last_output = 68, beat_lock = 130;
  if (word.letter != 'M') return false;
  const double number = word.number().value_or(beat_lock);
  return number == beat_lock || (number >= first_output && number <= last_output);
}

[[noreturn]] void refuse(const std::string& file, std::size_t line, std::string_view word) {
  throw Error(Exit::bad_input, fmt::format("{}:{}", file, line),
              fmt::format("--dry cannot leave '{}' out", word),
              "remove the line, or run the program with --board virtual");
}

std::string dark_line(const link::ProgramLine& line, const std::string& file) {
  std::string text;
  for (const ProgramWord& word : words_of(line.text)) {
    if (needs_laser(word)) refuse(file, line.number, trimmed(word.text));
    if (!switches_on(word)) text += word.text;
  }
  return std::string(trimmed(text));
}

}  // namespace

std::vector<link::ProgramLine> without_laser(const std::vector<link::ProgramLine>& lines,
                                             const std::string& file) {
  if (lines.empty()) return {};
  std::vector<link::ProgramLine> dark{{lines.front().number, "M5"}};
  std::vector<std::string> logs;
  for (const link::ProgramLine& line : lines) {
    if (line.text.starts_with('$')) refuse(file, line.number, line.text);
    std::string text = dark_line(line, file);
    logs.insert(logs.end(), line.logs.begin(), line.logs.end());
    if (!text.empty() || !line.messages.empty())
      dark.push_back(
          {line.number, std::move(text), line.messages, line.origin, std::exchange(logs, {})});
  }
  return dark;
}

}  // namespace lamplock::program_run
