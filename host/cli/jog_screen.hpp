// What somebody sees who moves a machine by hand: one line that changes, and notes.
//
// In:  the display of the jogger, the state of the machine. Out: a line that is drawn anew on a
//      terminal; elsewhere a line for each new state.
// Who: `lamplock jog`.
#pragma once

#include <chrono>
#include <string>

#include "host/pendant/jogger.hpp"

namespace lamplock::cli {

class Console;

/// "X 1.000  Y 0.000 | Idle | step 0.1 mm | X | feed 100 %", work coordinates of so many axes.
std::string jog_line(const pendant::Display& display, const link::BoardStatus& status);

class JogScreen {
 public:
  explicit JogScreen(Console& console);
  /// Leaves the line as it was last.
  ~JogScreen();
  JogScreen(const JogScreen&) = delete;
  JogScreen& operator=(const JogScreen&) = delete;

  void show(const pendant::Jogger& jogger);
  void note(const std::string& text);

 private:
  using Clock = std::chrono::steady_clock;
  Console& console_;
  bool terminal_;
  std::string drawn_, state_;
  Clock::time_point drawn_at_{};
};

}  // namespace lamplock::cli
