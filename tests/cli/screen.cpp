#include "tests/cli/screen.hpp"

#include <algorithm>
#include <cstdlib>

namespace lamplock::cli::test {
namespace {

constexpr char escape = '\x1b';

std::string without_spaces_at_end(std::string text) {
  text.resize(text.find_last_not_of(' ') + 1);
  return text;
}

}  // namespace

Screen::Screen(std::size_t columns, std::size_t height, Resizing resizing)
    : columns_(columns), height_(height), resizing_(resizing) {}

void Screen::write(std::string_view bytes) {
  for (const char c : bytes) {
    if (sequence_.empty() && c != escape) {
      static_cast<unsigned char>(c) < ' ' ? control(c) : put(c);
      continue;
    }
    sequence_ += c;
    const bool is_csi = sequence_.size() > 1 && sequence_[1] == '[';
    if (sequence_.size() == 1 || (is_csi && (sequence_.size() == 2 || c < '@'))) continue;
    execute(c);
    sequence_.clear();
  }
}

void Screen::put(char character) {
  if (wrap_pending_ && wraps_) {
    rows_[row_].wrapped = true;
    column_ = 0;
    line_feed();
  }
  wrap_pending_ = false;
  std::string& cells = rows_[row_].cells;
  if (cells.size() <= column_) cells.resize(column_ + 1, ' ');
  cells[column_] = character;
  if (column_ + 1 < columns_)
    ++column_;
  else
    wrap_pending_ = true;
}

void Screen::control(char character) {
  wrap_pending_ = false;
  if (character == '\r')
    column_ = 0;
  else if (character == '\n')
    line_feed();
  else if (character == '\b')
    column_ -= column_ > 0 ? 1u : 0u;
  else if (character != '\a')
    unknown_ += character;
}

void Screen::line_feed() {
  if (++row_ == rows_.size()) rows_.emplace_back();
}

std::size_t Screen::number(std::size_t usual) const {
  const auto value = std::strtoul(sequence_.c_str() + 2, nullptr, 10);
  return value == 0 ? usual : value;
}

void Screen::erase_right() {
  std::string& cells = rows_[row_].cells;
  cells.resize(std::min(cells.size(), column_));
  rows_[row_].wrapped = false;
}

void Screen::execute(char last) {
  wrap_pending_ = false;
  std::string& cells = rows_[row_].cells;
  if (sequence_ == "\x1b[K" || sequence_ == "\x1b[0K") return erase_right();
  if (sequence_ == "\x1b[J" || sequence_ == "\x1b[0J") {
    erase_right();
    for (std::size_t row = row_ + 1; row < rows_.size(); ++row) rows_[row] = Row{};
    return;
  }
  if (sequence_ == "\x1b[?7l" || sequence_ == "\x1b[?7h") {
    wraps_ = last == 'h';
  } else if (last == 'A') {
    row_ = std::max(row_ - std::min(row_, number(1)), top());
  } else if (last == 'C') {
    column_ = std::min(column_ + number(1), columns_ - 1);
  } else if (last == 'D') {
    column_ -= std::min(column_, number(1));
  } else if (last == 'G') {
    column_ = std::min(number(1), columns_) - 1;
  } else if (last == 'P') {
    cells.erase(std::min(column_, cells.size()), number(1));
  } else if (last == '@') {
    cells.insert(std::min(column_, cells.size()), number(1), ' ');
    cells.resize(std::min(cells.size(), columns_));
  } else if (last != 'm') {
    unknown_ += sequence_;
  }
}

void Screen::resize(std::size_t columns) {
  wrap_pending_ = false;
  if (resizing_ == Resizing::wraps) {
    wrap_again(columns);
  } else {
    for (Row& row : rows_) row.cells.resize(std::min(row.cells.size(), columns));
    column_ = std::min(column_, columns - 1);
  }
  columns_ = columns;
}

void Screen::wrap_again(std::size_t columns) {
  std::vector<Row> rows;
  std::size_t cursor_row = 0, cursor_column = 0;
  for (std::size_t begin = 0, end = 0; begin < rows_.size(); begin = end) {
    std::string line;
    std::size_t cursor = std::string::npos;
    bool continues = true;
    for (end = begin; continues && end < rows_.size(); ++end) {
      continues = rows_[end].wrapped;
      if (end == row_) cursor = line.size() + column_;
      line += rows_[end].cells;
    }
    if (cursor != std::string::npos) {
      line.resize(std::max(line.size(), cursor), ' ');
      cursor_row = rows.size() + cursor / columns;
      cursor_column = cursor % columns;
    }
    for (std::size_t at = 0; at == 0 || at < line.size(); at += columns)
      rows.push_back({line.substr(at, columns), at + columns < line.size()});
  }
  rows_ = std::move(rows);
  row_ = cursor_row;
  column_ = cursor_column;
  while (rows_.size() <= row_) rows_.emplace_back();
}

std::vector<std::string> Screen::lines() const {
  std::vector<std::string> result;
  bool continues = false;
  for (const Row& row : rows_) {
    if (!continues) result.emplace_back();
    result.back() += row.cells;
    continues = row.wrapped;
  }
  for (std::string& line : result) line = without_spaces_at_end(line);
  while (!result.empty() && result.back().empty()) result.pop_back();
  return result;
}

std::string Screen::cursor_line() const { return without_spaces_at_end(rows_[row_].cells); }

}  // namespace lamplock::cli::test
