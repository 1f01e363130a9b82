#include "host/run/program_refusal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "host/program/board_lines.hpp"
#include "host/program/line_column.hpp"
#include "host/program/program_error.hpp"
#include "host/program/program_words.hpp"
#include "host/program/user_command.hpp"
#include "host/text.hpp"

namespace lamplock::run {
namespace {

std::string line_place(const ProgramText& program, std::size_t number) {
  return fmt::format("{}:{}", program.file, number);
}

/// A program is run with a pause in place of a user command.
void name_user_command(const link::ProgramLine& line, std::string& text) {
  const std::string stand_in = fmt::format("'{}'", program_run::stand_in);
  const std::size_t at = text.find(stand_in);
  if (at == std::string::npos) return;
  for (const program_run::ProgramWord& word : program_run::words_of(line.text))
    if (word.letter == 'M' && program_run::is_user_command(word.text))
      text.replace(at, stand_in.size(), fmt::format("'{}'", trimmed(word.text)));
}

/// In the file of the line.
std::size_t column_of(const ProgramText& program, const link::ProgramLine& sent, unsigned column) {
  if (!sent.source.empty()) return program_run::column_in_file(sent, column);
  std::string_view rest = without_byte_order_mark(program.source), line;
  for (std::size_t i = 0; i < sent.number; ++i) line = take_line(rest);
  if (column == 0 || link::text_to_send(line) != sent.text) return 0;
  return link::column_in_line(line, column);
}

/// An error about a line of the input that has no parts; nothing of other errors.
std::optional<program_run::Problem> problem_in_text(const Error& error, const std::string& input) {
  std::string_view rest = error.message();
  const auto take_number = [&rest] {
    if (!rest.starts_with(':')) return std::size_t{0};
    const std::string_view text = rest.substr(1, rest.find(':', 1) - 1);
    const auto number = number_of<std::size_t>(text).value_or(0);
    if (number != 0) rest.remove_prefix(text.size() + 1);
    return number;
  };
  if (!rest.starts_with(input)) return std::nullopt;
  rest.remove_prefix(input.size());
  const std::size_t line = take_number();
  if (line == 0) return std::nullopt;
  const auto column = static_cast<unsigned>(take_number());
  if (!rest.starts_with(": ")) return std::nullopt;
  rest.remove_prefix(2);
  return program_run::Problem{line, column, 0, std::string(rest)};
}

program_run::Problem problem_in_parts(const program_run::ProgramError& error,
                                      const std::string& input) {
  program_run::Problem problem{error.program_line(), 0, error.number(), error.text(),
                               error.remedy()};
  if (error.place().file == input)
    problem.column = static_cast<unsigned>(error.place().column);
  else if (error.place().line != 0 || !error.remedy().empty())
    problem.text = fmt::format("in {}: {}", text_of(error.place()), error.text());
  return problem;
}

}  // namespace

void check_board_lines(const ProgramText& program) {
  const auto is_for_board = [](const link::ProgramLine& line) {
    return program_run::is_board_line(line.text);
  };
  if (std::all_of(program.lines.begin(), program.lines.end(), is_for_board)) return;
  for (const link::ProgramLine& line : program.lines) {
    const std::string fault = program_run::board_line_fault(line.text);
    if (fault.empty()) continue;
    throw Error(Exit::bad_input, line_place(program, line.number), fault + ", nothing was sent",
                "send it before the program, or add --ignore-errors");
  }
}

void refuse_sleep(const ProgramText& program) {
  for (const link::ProgramLine& line : program.lines)
    if (program_run::is_sleep(line.text))
      throw Error(Exit::bad_input, line_place(program, line.number),
                  program_run::board_line_fault(line.text) + ", nothing was sent",
                  "take it out and send it with lamplock console after the program");
}

program_run::Problem in_file(const ProgramText& program, program_run::Problem problem) {
  const link::ProgramLine& sent = program.lines[std::min(problem.line, program.lines.size()) - 1];
  const std::size_t column = column_of(program, sent, problem.column);
  name_user_command(sent, problem.text);
  problem.line = sent.number;
  problem.column = sent.origin.empty() ? static_cast<unsigned>(column) : 0;
  if (sent.origin.empty()) return problem;
  const std::string place = column == 0 ? sent.origin : fmt::format("{}:{}", sent.origin, column);
  problem.text = fmt::format("in {}: {}", place, problem.text);
  return problem;
}

std::optional<program_run::Problem> problem_of(const Error& error, const std::string& input) {
  const auto* const of_program = dynamic_cast<const program_run::ProgramError*>(&error);
  return of_program != nullptr ? problem_in_parts(*of_program, input)
                               : problem_in_text(error, input);
}

Error refusal_of(const ProgramText& program, const program_run::Problem& problem) {
  const program_run::Problem here = in_file(program, problem);
  const std::string number = here.error == 0 ? "" : fmt::format("error:{} ", here.error);
  const std::string remedy = here.remedy.empty()
                                 ? "correct it, see all with lamplock check, or add --ignore-errors"
                                 : here.remedy + "; lamplock check lists all";
  return {Exit::bad_input, program_run::text_of({program.file, here.line, here.column}),
          number + here.text + ", nothing was sent", remedy};
}

}  // namespace lamplock::run
