#include "host/program/line_column.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "host/program/program_words.hpp"

namespace lamplock::program_run {
namespace {

/// The columns of the words of a line without its assignments, which the board does not get.
std::vector<std::size_t> word_columns(std::string_view line) {
  std::vector<std::size_t> columns;
  for (const ProgramWord& word : words_of(line))
    if (word.letter != '#')
      columns.push_back(static_cast<std::size_t>(word.text.data() - line.data()) + 1);
  return columns;
}

}  // namespace

std::size_t column_in_file(const link::ProgramLine& line, std::size_t column) {
  if (column == 0 || line.source.empty()) return 0;
  const std::string plain = link::text_to_send(line.source);
  if (plain == line.text) return link::column_in_line(line.source, column);
  const std::vector<std::size_t> from = word_columns(line.text), to = word_columns(plain);
  const auto after = std::ranges::upper_bound(from, column);
  if (from.size() != to.size() || after == from.begin()) return 0;
  return link::column_in_line(line.source, to[static_cast<std::size_t>(after - from.begin()) - 1]);
}

std::size_t column_of_statement(const link::ProgramLine& line, std::size_t column) {
  return line.source.empty() || column == 0 ? column : link::column_in_line(line.source, column);
}

std::size_t column_without_blanks(std::string_view line, std::size_t index) {
  for (std::size_t i = 0; i < line.size(); ++i)
    if (static_cast<unsigned char>(line[i]) > ' ' && index-- == 0) return i + 1;
  return 0;
}

}  // namespace lamplock::program_run
