#include "host/run/program_refusal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "host/program/board_lines.hpp"
#include "host/text.hpp"

namespace lamplock::run {
namespace {

std::string line_place(const ProgramText& program, std::size_t number) {
  return fmt::format("{}:{}", program.file, number);
}

std::string column_place(const ProgramText& program, const link::ProgramLine& sent,
                         unsigned column) {
  std::string place = line_place(program, sent.number);
  std::string_view rest = without_byte_order_mark(program.source), line;
  for (std::size_t i = 0; i < sent.number; ++i) line = take_line(rest);
  if (column == 0 || link::text_to_send(line) != sent.text) return place;
  return fmt::format("{}:{}", place, link::column_in_line(line, column));
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
                "send it before the program, or send it anyhow with --ignore-errors");
  }
}

void refuse_sleep(const ProgramText& program) {
  for (const link::ProgramLine& line : program.lines)
    if (program_run::is_sleep(line.text))
      throw Error(Exit::bad_input, line_place(program, line.number),
                  program_run::board_line_fault(line.text) + ", nothing was sent",
                  "take it out and send it with lamplock console after the program");
}

Error refusal_of(const ProgramText& program, const program_run::Problem& problem) {
  const std::size_t at = std::min(problem.line, program.lines.size()) - 1;
  const std::string number = problem.error == 0 ? "" : fmt::format("error:{} ", problem.error);
  const std::string remedy =
      problem.remedy.empty()
          ? "correct it, see all with lamplock check, or send it anyhow with --ignore-errors"
          : problem.remedy + "; lamplock check lists all";
  const std::string& origin = program.lines[at].origin;
  const std::string in_file = origin.empty() ? "" : fmt::format("in {}: ", origin);
  return {Exit::bad_input, column_place(program, program.lines[at], problem.column),
          number + in_file + problem.text + ", nothing was sent", remedy};
}

}  // namespace lamplock::run
