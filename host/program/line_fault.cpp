#include "host/program/line_fault.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <utility>

#include "host/letter_case.hpp"
#include "host/printable.hpp"
#include "host/program/missing_word.hpp"
#include "host/program/process_values.hpp"
#include "host/program/program_words.hpp"
#include "host/program/state_fault.hpp"
#include "host/program/user_command.hpp"
#include "host/text.hpp"
#include "shared/gcode_errors.hpp"
#include "shared/gcode_words.hpp"
#include "shared/units.hpp"

namespace lamplock::program_run {
namespace {

constexpr std::string_view number_characters = "+-.0123456789", blanks = " \t";

/// The text in quotes, short enough for a message.
std::string quoted(std::string_view text) {
  constexpr std::size_t max_shown = 40;
  if (text.size() <= max_shown) return fmt::format("'{}'", printable(text));
  return fmt::format("'{}...'", printable(text.substr(0, max_shown)));
}

/// The word at the begin of a text: its letter and its number, with blanks between them.
std::string_view word_at(std::string_view text) {
  std::size_t end = 1;
  for (std::size_t i = 1; i < text.size(); ++i) {
    if (number_characters.find(text[i]) != std::string_view::npos)
      end = i + 1;
    else if (blanks.find(text[i]) == std::string_view::npos)
      break;
  }
  return text.substr(0, end);
}

std::string_view without_blanks_before(std::string_view text) {
  return text.substr(std::min(text.find_first_not_of(blanks), text.size()));
}

std::string_view letters_at(std::string_view text) {
  const auto end = std::ranges::find_if(
      text, [](char c) { return std::isalpha(static_cast<unsigned char>(c)) == 0; });
  return text.substr(0, static_cast<std::size_t>(end - text.begin()));
}

/// Words of control flow of LinuxCNC, Fanuc and RepRapFirmware; each begins at its fault.
bool is_control_word(std::string_view letters) {
  constexpr std::array<std::string_view, 16> words{
      "WHILE", "IF",   "GOTO",   "DO",     "END",      "THEN",  "ELSE",  "ELSEIF",
      "ENDIF", "CALL", "REPEAT", "RETURN", "CONTINUE", "BREAK", "ABORT", "VAR"};
  return std::ranges::find(words, in_upper_case(letters)) != words.end();
}

/// A checksum at the fault, `*22`; empty if there is none.
std::string_view checksum_at(std::string_view rest) {
  const std::string_view after = without_blanks_before(rest.substr(word_at(rest).size()));
  if (rest.front() == '*') return word_at(rest);
  if (after.starts_with('*')) return word_at(after);
  return {};
}

/// Remedies for commands of other machines.
struct Replacement {
  char letter;
  double number;
  std::string_view remedy;
};

constexpr std::string_view no_subprograms =
    "write O-words or M98 (docs/gcode.md), or post the program without loops";
constexpr std::string_view no_motor_switch =
    "take the word out: $1 switches the motors off at rest";
constexpr std::string_view no_heater = "take the word out: the machine has no heater";
constexpr std::string_view no_program_output =
    "give the profile of a machine with AUX OUT and AUX IN, such as pin_map = 2, or take the "
    "word out";
constexpr std::array replacements{
    Replacement{'M', 62, no_program_output}, Replacement{'M', 63, no_program_output},
    Replacement{'M', 64, no_program_output}, Replacement{'M', 65, no_program_output},
    Replacement{'M', 66, no_program_output}, Replacement{'M', 67, no_program_output},
    Replacement{'M', 68, no_program_output}, Replacement{'M', 97, no_subprograms},
    Replacement{'M', 98, no_subprograms},    Replacement{'M', 99, no_subprograms},
    Replacement{'M', 17, no_motor_switch},   Replacement{'M', 18, no_motor_switch},
    Replacement{'M', 84, no_motor_switch},   Replacement{'M', 104, no_heater},
    Replacement{'M', 109, no_heater},        Replacement{'M', 140, no_heater},
    Replacement{'M', 190, no_heater},
};

LineFault unsupported(std::string_view word, int axes) {
  constexpr std::string_view axes_of_others = "ABCUVW";
  const std::string letters = in_upper_case(word.substr(0, 1));
  const std::string_view own(axis_letters.data(), static_cast<std::size_t>(axes));
  if (axes_of_others.find(letters) != std::string_view::npos &&
      own.find(letters) == std::string_view::npos)
    return {fmt::format("{} is for an axis that the machine does not have", quoted(word)),
            fmt::format("take the word out: its axes are {}", fmt::join(own, ", "))};
  LineFault fault{fmt::format("{} is not supported", quoted(word)),
                  "take the word out, or post the program for grbl"};
  for (const ProgramWord& one : words_of(word))
    for (const Replacement& other : replacements)
      if (one.is(other.letter, other.number)) {
        fault.remedy = other.remedy;
        return fault;
      }
  if (is_user_command(word))
    return {fmt::format("{} is a user command, and none are permitted", quoted(word)),
            "lamplock check and lamplock send run it with --user-commands FOLDER"};
  return fault;
}

LineFault no_letter(std::string_view rest) {
  if (rest.front() == ',')
    return {"',' is not part of a number or a word", "write numbers with a decimal point"};
  return {fmt::format("a word must begin with a letter, not with {}", quoted(rest.substr(0, 1))),
          "take it out, or put text into a comment"};
}

LineFault unknown_name(std::string_view rest, const std::string& text) {
  const std::string_view name = rest.substr(0, std::min(rest.find('>'), rest.size() - 1) + 1);
  if (has_process_values(name))
    return {fmt::format("{} is a process parameter, which the machine does not know", quoted(name)),
            "lamplock check and lamplock send insert its value: --material NAME"};
  return {fmt::format("{}: {}", quoted(name), text),
          fmt::format("write '{} = 0' with its value before this line", printable(name))};
}

/// A number, with a letter or without.
std::string_view number_at(std::string_view text) {
  const std::string_view digits = "0123456789. \t";
  if (digits.find(text.front()) == std::string_view::npos) return word_at(text);
  return trimmed(text.substr(0, text.find_first_not_of(digits)));
}

/// A number with more digits before its point than the machine reads (shared/gcode_words.hpp).
bool is_too_large(std::string_view number) {
  std::size_t digits = 0;
  for (const char c : number) {
    if (c == '.') break;
    if (std::isdigit(static_cast<unsigned char>(c)) != 0 && (digits != 0 || c != '0')) ++digits;
  }
  return digits > static_cast<std::size_t>(program::max_digits);
}

/// EXISTS[...], whose bracket is at the fault.
std::optional<LineFault> bad_exists(std::string_view before, std::string_view rest) {
  constexpr std::string_view function = "EXISTS";
  before = trimmed(before);
  if (before.size() < function.size() ||
      in_upper_case(before.substr(before.size() - function.size())) != function)
    return std::nullopt;
  const std::string_view end = rest.substr(0, std::min(rest.find(']'), rest.size() - 1) + 1);
  const std::string call = fmt::format("EXISTS{}", end);
  return LineFault{
      fmt::format("{}: EXISTS asks for a name, EXISTS[#<name>]", quoted(std::string_view(call))),
      "write a name; numbered parameters need no question, they are 0 until they are set"};
}

/// An error of a value: the word that has it comes first.
LineFault bad_value(std::string_view rest, const std::string& text) {
  if (std::isalpha(static_cast<unsigned char>(rest.front())) == 0) return {text};
  const auto words = words_of(rest);
  return {fmt::format("{}: {}", quoted(trimmed(words.front().text)), text)};
}

/// What is not a word: neither a letter with a number, nor a letter with a value.
LineFault no_word(std::string_view rest, GcodeError error) {
  if (const std::string_view sum = checksum_at(rest); !sum.empty())
    return {fmt::format("{}: line checksums are not read", quoted(sum)),
            "switch them off in the sender"};
  if (const std::string_view letters = letters_at(rest); is_control_word(letters))
    return {fmt::format("{}: loops, branches and calls in this form are not read", quoted(letters)),
            std::string(no_subprograms)};
  if (error == GcodeError::letter_expected) return no_letter(rest);
  if (const std::string_view number = number_at(rest); is_too_large(number))
    return {fmt::format("{} is too large: the numbers of a program are between -1000000000 and "
                        "1000000000",
                        quoted(number)),
            "correct the number"};
  return {fmt::format("the number after {} is missing, malformed or too large",
                      quoted(rest.substr(0, 1))),
          "correct the number, or put text into a comment"};
}

}  // namespace

LineFault describe_fault(std::string_view line, const program::Fault& fault, int axes,
                         const program::Interpreter* interpreter) {
  const GcodeErrorRow* row = find_gcode_error(static_cast<std::uint8_t>(fault.error));
  LineFault plain{row == nullptr ? "unknown" : std::string(row->text)};
  if (fault.column == 0 || fault.column > line.size()) return plain;
  const std::string_view rest = line.substr(fault.column - 1);
  if (interpreter != nullptr)
    if (auto of_state = describe_state_fault(line, word_at(rest), fault.error, *interpreter))
      return *std::move(of_state);
  switch (fault.error) {
    case GcodeError::unsupported:
      return unsupported(word_at(rest), axes);
    case GcodeError::unknown_name:
      return unknown_name(rest, plain.text);
    case GcodeError::o_word:
      return {fmt::format("{}: O-words are not read here", quoted(trimmed(rest))),
              "lamplock check and lamplock send run them"};
    case GcodeError::letter_expected:
    case GcodeError::bad_number:
      return no_word(rest, fault.error);
    case GcodeError::value_missing:
      if (const auto text = missing_words(line, fault.column, interpreter))
        return {*text, "add it to the line"};
      return plain;
    case GcodeError::bad_expression:
      return bad_exists(line.substr(0, fault.column - 1), rest).value_or(plain);
    case GcodeError::negative_value:
    case GcodeError::not_integer:
    case GcodeError::not_positive:
    case GcodeError::out_of_range:
    case GcodeError::no_such_system:
    case GcodeError::tool_too_large:
    case GcodeError::unknown_tool:
    case GcodeError::words_unused:
      return bad_value(rest, plain.text);
    default:
      return plain;
  }
}

}  // namespace lamplock::program_run
