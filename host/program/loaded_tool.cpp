#include "host/program/loaded_tool.hpp"

#include <algorithm>
#include <array>

#include "host/letter_case.hpp"
#include "host/program/program_words.hpp"

namespace lamplock::program_run {
namespace {

/// Parameters of the tool in the spindle and of the length in force (docs/gcode.md, Expressions and
/// parameters).
constexpr std::array<std::string_view, 5> tool_parameters{"#5400", "#5403", "#5410",
                                                          "#<_CURRENT_TOOL>", "#<_TOOL_OFFSET>"};

bool has_letter(const std::vector<ProgramWord>& words, char letter) {
  return std::ranges::any_of(words,
                             [letter](const ProgramWord& word) { return word.letter == letter; });
}

/// Upper case without blanks.
std::string plain_text(std::string_view line) {
  std::string text;
  for (const char c : line)
    if (c != ' ' && c != '\t') text += upper_case(c);
  return text;
}

/// The code that takes the tool in the spindle because the line has no number of a tool.
std::string code_without_number(const std::vector<ProgramWord>& words) {
  for (const ProgramWord& word : words) {
    if (word.is('G', 43) && !has_letter(words, 'H')) return "G43";
    if ((word.is('G', 41) || word.is('G', 42)) && !has_letter(words, 'D'))
      return std::string(trimmed(word.text));
  }
  return {};
}

}  // namespace

std::string LoadedTool::pass(std::string_view line) {
  if (is_known_) return {};
  const auto words = words_of(line);
  const std::string text = plain_text(line);
  for (const std::string_view name : tool_parameters)
    if (text.find(name) != std::string::npos) return std::string(name);
  is_known_ = std::ranges::any_of(
      words, [](const ProgramWord& word) { return word.is('M', 6) || word.is('M', 61); });
  return is_known_ ? std::string() : code_without_number(words);
}

bool knows_tool(const std::optional<BoardState>& state) { return state && state->loaded_tool; }

bool uses_unknown_tool(const std::vector<link::ProgramLine>& lines,
                       const std::optional<BoardState>& state) {
  LoadedTool tool(knows_tool(state));
  return std::ranges::any_of(
      lines, [&tool](const link::ProgramLine& line) { return !tool.pass(line.text).empty(); });
}

}  // namespace lamplock::program_run
