#include "host/program/program_words.hpp"

#include <algorithm>
#include <cctype>

#include "host/letter_case.hpp"

namespace lamplock::program_run {
namespace {

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }
bool begins_word(char c) { return is_letter(c) || c == '#'; }

std::size_t after_any(std::string_view line, std::size_t at, std::string_view characters) {
  return std::min(line.find_first_not_of(characters, at), line.size());
}

/// Index after the bracket that is closed where the one at this index ends.
std::size_t after_bracket(std::string_view line, std::size_t at) {
  std::size_t depth = 0;
  for (; at < line.size(); ++at) {
    if (line[at] == '[') ++depth;
    if (line[at] == ']' && --depth == 0) return at + 1;
  }
  return at;
}

/// Index of the bracket of a function at this index, of two letters at least; the index itself
/// without one.
std::size_t bracket_of_function(std::string_view line, std::size_t at) {
  std::size_t end = at, letters = 0;
  for (; end < line.size() && (is_letter(line[end]) || line[end] == ' '); ++end)
    letters += is_letter(line[end]) ? 1u : 0u;
  return letters > 1 && end < line.size() && line[end] == '[' ? end : at;
}

/// Index after a value with letters of its own, or after what precedes a plain number.
std::size_t after_value(std::string_view line, std::size_t at) {
  constexpr std::string_view before_number = " \t+-#", between = " \t";
  at = bracket_of_function(line, after_any(line, at, before_number));
  if (at < line.size() && line[at] == '<') return std::min(line.find('>', at), line.size() - 1) + 1;
  if (at == line.size() || line[at] != '[') return at;
  at = after_bracket(line, at);
  const std::size_t slash = after_any(line, at, between);
  if (slash == line.size() || line[slash] != '/') return at;
  const std::size_t second = after_any(line, slash + 1, between);
  return second < line.size() && line[second] == '[' ? after_bracket(line, second) : at;
}

}  // namespace

std::vector<ProgramWord> words_of(std::string_view line) {
  std::vector<ProgramWord> words;
  for (std::size_t i = 0; i < line.size();) {
    if (!begins_word(line[i])) {
      ++i;
      continue;
    }
    std::size_t end = after_value(line, i + 1);
    if (line[i] == '#') {
      const std::size_t sign = std::min(line.find_first_of("=#", end), line.size());
      if (sign < line.size() && line[sign] == '=') end = after_value(line, sign + 1);
    }
    while (end < line.size() && !begins_word(line[end])) ++end;
    words.push_back({upper_case(line[i]), line.substr(i, end - i)});
    i = end;
  }
  return words;
}

std::string without_code(std::string_view line, char letter, double number) {
  const auto words = words_of(line);
  if (words.empty()) return std::string(line);
  std::string rest(
      line.substr(0, static_cast<std::size_t>(words.front().text.data() - line.data())));
  for (const ProgramWord& word : words)
    if (!word.is(letter, number)) rest += word.text;
  return std::string(trimmed(rest));
}

}  // namespace lamplock::program_run
