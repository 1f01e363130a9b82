#include "host/program/board_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "host/letter_case.hpp"
#include "host/link/program_lines.hpp"
#include "host/text.hpp"

namespace lamplock::program_run {
namespace {

/// As the board reads a `$` line: without white space, in upper case.
std::string command_of(std::string_view line) {
  std::string text;
  for (const char c : line)
    if (c != ' ' && c != '\t') text += upper_case(c);
  return text;
}

bool may_be_in_program(const std::string& command) {
  constexpr std::array<std::string_view, 7> plain{"$", "$$", "$#", "$G", "$I", "$N", "$X"};
  constexpr std::size_t max_homing_size = 3;  // $HX
  if (command.starts_with("$H")) return command.size() <= max_homing_size;
  return std::ranges::find(plain, command) != plain.end();
}

}  // namespace

bool is_board_line(std::string_view line) { return line.starts_with('$'); }

std::string board_line_fault(std::string_view line) {
  if (!is_board_line(line) || may_be_in_program(command_of(line))) return {};
  return fmt::format("'{}' must not be in a program", line);
}

bool is_sleep(std::string_view line) { return command_of(line) == "$SLP"; }

bool has_only_board_lines(std::string_view text) {
  text = without_byte_order_mark(text);
  while (!text.empty()) {
    const std::string line = link::text_to_send(take_line(text));
    if (line.find_first_not_of("% \t") != std::string::npos && !is_board_line(line)) return false;
  }
  return true;
}

}  // namespace lamplock::program_run
