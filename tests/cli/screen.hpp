// A terminal's screen: what a user sees of the bytes that a program writes.
//
// In:  bytes; other widths. Out: lines of text. Who: tests of what is redrawn on a terminal.
//
// Rows wrap at the width, the screen scrolls and keeps what has left it. A change of the width
// wraps all lines again, as most terminals do, or cuts them off, as xterm does. It knows the
// control sequences that lamplock and its line editor use; any other one is reported.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace lamplock::cli::test {

class Screen {
 public:
  enum class Resizing { wraps, cuts };

  Screen(std::size_t columns, std::size_t height, Resizing resizing);

  void write(std::string_view bytes);
  void resize(std::size_t columns);

  /// All lines, also those that have left the screen; rows that were wrapped are one line. Without
  /// spaces at their ends.
  std::vector<std::string> lines() const;
  /// The line of the cursor.
  std::string cursor_line() const;
  std::size_t cursor_column() const { return column_; }
  /// Control sequences that are not known, in their order.
  const std::string& unknown() const { return unknown_; }

 private:
  struct Row {
    std::string cells;
    bool wrapped = false;  ///< the next row continues it
  };

  void put(char character);
  void control(char character);
  void execute(char last);
  void line_feed();
  void erase_right();
  void wrap_again(std::size_t columns);
  std::size_t top() const { return rows_.size() > height_ ? rows_.size() - height_ : 0; }
  std::size_t number(std::size_t usual) const;

  std::size_t columns_, height_;
  Resizing resizing_;
  std::vector<Row> rows_{Row{}};
  std::size_t row_ = 0, column_ = 0;
  bool wraps_ = true;          ///< DECAWM
  bool wrap_pending_ = false;  ///< the last column is written
  std::string sequence_;       ///< an escape sequence that has begun
  std::string unknown_;
};

}  // namespace lamplock::cli::test
