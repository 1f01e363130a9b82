#include "host/program/subprogram_call.hpp"

#include <fmt/format.h>

#include <optional>

#include "host/program/program_words.hpp"
#include "host/text.hpp"

namespace lamplock::program_run {
namespace {

/// The line of the number, O1000 G90, if it has words of its own; otherwise the one after it.
std::size_t first_statement(const FlowUnit& unit, std::size_t of_number) {
  for (const ProgramWord& word : words_of(unit.statements[of_number].line.text))
    if (word.letter != 'O' && word.letter != 'N') return of_number;
  return of_number + 1;
}

}  // namespace

SubprogramCall subprogram_call_of(const std::string& line, const FlowUnit& unit,
                                  const FlowPlace& place) {
  std::string seen;
  std::optional<double> program, count = 1;
  for (const ProgramWord& word : words_of(line)) {
    if (word.letter == 'P')
      program = word.number();
    else if (word.letter == 'L')
      count = word.number();
    else if (word.letter != 'N' && !word.is('M', 98))
      place.refuse(fmt::format("M98 has another word, {}", trimmed(word.text)),
                   "write M98 P and L in their own line");
    if (seen.find(word.letter) != std::string::npos)
      place.refuse(fmt::format("the line has two words {}", word.letter),
                   "write one M98, P and L in a line");
    seen += word.letter;
  }
  if (!program || !count)
    place.refuse("M98 has no number P", "write M98 P and the program's number");
  const auto found = unit.programs.find(fmt::format("{:.0f}", *program));
  if (found == unit.programs.end())
    place.refuse(fmt::format("there is no program O{:.0f}", *program),
                 "write it after M30: a line with O and its number, then its lines and M99");
  return {first_statement(unit, found->second), static_cast<std::int64_t>(*count)};
}

}  // namespace lamplock::program_run
