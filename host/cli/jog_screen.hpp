// The view of `lamplock jog` on a terminal: one line that changes, and notes.
//
// In:  the display of the jogger, the state of the machine. Out: a line that is redrawn on a
//      terminal; elsewhere a line for each new state. Who: `lamplock jog`.
#pragma once

#include <chrono>
#include <string>

#include "host/run/jog_session.hpp"

namespace lamplock::cli {

class Console;

/// "X 1.000  Y 0.000 | Idle | step 0.1 mm | X | feed 100 %", work coordinates of so many axes.
std::string jog_line(const pendant::Display& display, const link::BoardStatus& status);

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
  using Clock = std::chrono::steady_clock;
  Console& console_;
  bool terminal_;
  std::string drawn_, state_;
  Clock::time_point drawn_at_{};
};

}  // namespace lamplock::cli
