// The view of `lamplock jog` on a terminal: one line that changes, and notes.
//
// In:  the display of the jogger, the state of the machine. Out: a line that is redrawn on a
//      terminal (live_line.hpp); elsewhere a line for each new state. Who: `lamplock jog`.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "host/cli/live_line.hpp"
#include "host/run/jog_session.hpp"

namespace lamplock::cli {

class Console;

/// "X 1.000  Y 0.000  | Idle | step 0.1 mm | X | feed 100 %", work coordinates of so many axes, in
/// at most so many columns: if they are few, fields at the end are left out, then decimal places,
/// then axes after X. No number is cut off.
std::string jog_line(const pendant::Display& display, const link::BoardStatus& status,
                     std::size_t columns);

class JogScreen : public run::JogView {
 public:
  explicit JogScreen(Console& console);
  /// Leaves the last line on the terminal.
  ~JogScreen() override;
  JogScreen(const JogScreen&) = delete;
  JogScreen& operator=(const JogScreen&) = delete;

  void show(const pendant::Jogger& jogger) override;
  void note(const std::string& text) override;
  bool has_keyboard() const override;
  std::unique_ptr<run::JogKeys> open_keys() override;

 private:
  Console& console_;
  pendant::Display display_;
  link::BoardStatus status_;
  std::string state_;             ///< printed last, without a terminal
  std::optional<LiveLine> line_;  ///< on a terminal
};

}  // namespace lamplock::cli
