#include "host/program/user_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "host/error.hpp"
#include "host/link/program_lines.hpp"
#include "host/printable.hpp"
#include "host/program/program_words.hpp"
#include "host/text.hpp"

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

std::optional<UserCommand> user_command_of(std::string_view line, const std::string& where) {
  if (!is_user_command(line)) return std::nullopt;
  UserCommand command;
  for (const ProgramWord& word : words_of(line)) {
    if (word.letter == 'N') continue;
    const int number = command_number(word);
    const bool is_argument = word.letter == 'P' || word.letter == 'Q';
    if ((number == 0 && !is_argument) || (number != 0 && command.number != 0))
      throw Error(
          Exit::bad_input, where,
          fmt::format("'{}' is in the line of a user command", printable(trimmed(word.text))),
          "write M100 to M199 in their own line, with P and Q only");
    if (number != 0) {
      command.number = number;
      continue;
    }
    if (!word.number())
      throw Error(Exit::bad_input, where,
                  fmt::format("'{}' is not a number", printable(trimmed(word.text))),
                  "correct the value");
    (word.letter == 'P' ? command.p : command.q) = *word.number();
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
