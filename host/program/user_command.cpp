#include "host/program/user_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/printable.hpp"
#include "host/program/line_column.hpp"
#include "host/program/program_error.hpp"
#include "host/program/program_words.hpp"
#include "host/text.hpp"
#include "shared/gcode_errors.hpp"

namespace lamplock::program_run {
namespace {

constexpr int first_command = 100, last_command = 199, message_code = 117;
constexpr std::array codes_of_machine{message_code, 126, 127, 128, 130, 131};

/// The number of the command; 0 of other words.
int command_number(const ProgramWord& word) {
  const double number = word.letter == 'M' ? word.number().value_or(0) : 0;
  const int code = number >= first_command && number <= last_command ? static_cast<int>(number) : 0;
  if (code != number || std::ranges::find(codes_of_machine, code) != codes_of_machine.end())
    return 0;
  return code;
}

[[noreturn]] void refuse(const link::ProgramLine& line, const std::string& file,
                         const ProgramWord& word, const std::string& what,
                         const std::string& remedy, GcodeError error = GcodeError::none) {
  const auto own = static_cast<std::size_t>(word.text.data() - line.text.data()) + 1;
  const std::size_t column = line.source.empty() ? own : column_in_file(line, own);
  const bool is_here = line.origin.empty();
  const std::string in_file = is_here ? "" : fmt::format("in {}:{}: ", line.origin, column);
  throw ProgramError({file, line.number, is_here ? column : 0},
                     fmt::format("{}'{}' {}", in_file, printable(trimmed(word.text)), what), remedy,
                     static_cast<int>(error));
}

/// The value of P or Q.
double value_of(const link::ProgramLine& line, const std::string& file, const ProgramWord& word) {
  // Numbers of a program have nine digits before the point (shared/gcode_words.hpp).
  constexpr double too_large = 1e9;
  std::string_view text = trimmed(word.text.substr(1));
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto value = number_of<double>(trimmed(text));
  if (!value) refuse(line, file, word, "is not a number", "correct the value");
  if (std::abs(*value) >= too_large)
    refuse(line, file, word,
           "is too large: the numbers of a program are between -1000000000 and 1000000000",
           "correct the number", GcodeError::bad_number);
  return *value;
}

}  // namespace

std::string UserCommand::name() const { return fmt::format("M{}", number); }

bool is_user_command(std::string_view line) {
  if (line.find('1') == std::string_view::npos || line.starts_with('$')) return false;
  for (const ProgramWord& word : words_of(line)) {
    if (word.is('M', message_code)) return false;  // text follows
    if (command_number(word) != 0) return true;
  }
  return false;
}

std::optional<UserCommand> user_command_of(const link::ProgramLine& line, const std::string& file) {
  if (!is_user_command(line.text)) return std::nullopt;
  UserCommand command;
  std::string seen;
  for (const ProgramWord& word : words_of(line.text)) {
    if (word.letter == 'N') continue;
    const int number = command_number(word);
    const bool is_argument = word.letter == 'P' || word.letter == 'Q';
    if ((number == 0 && !is_argument) || (number != 0 && command.number != 0))
      refuse(line, file, word, "is in the line of a user command",
             "write M100 to M199 in their own line, with P and Q only");
    if (number != 0) {
      command.number = number;
      continue;
    }
    if (seen.find(word.letter) != std::string::npos)
      refuse(line, file, word, "occurs twice in the line", "take one of them out",
             GcodeError::word_repeated);
    seen += word.letter;
    (word.letter == 'P' ? command.p : command.q) = value_of(line, file, word);
  }
  return command;
}

std::string without_user_commands(std::string_view program) {
  program = without_byte_order_mark(program);
  std::string result;
  while (!program.empty()) {
    const std::string_view line = take_line(program);
    result += is_user_command(link::text_to_send(line)) ? stand_in : line;
    result += '\n';
  }
  return result;
}

}  // namespace lamplock::program_run
