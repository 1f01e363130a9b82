// The user's hand on a running program of G-code: Ctrl-C, Enter, hold, feed.
//
// In:  interrupts, lines on stdin, the state of the machine. Out: wishes to the sender, notes.
//      Ctrl-C stops; `!` holds, a blank line or `~` goes on; `+`, `-` and `=` change the feed.
//      Unless it waits for an answer only a terminal is read.
// Who: run_program, after every step of the sender.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "host/cli/interrupt.hpp"
#include "host/cli/keyboard.hpp"
#include "host/cli/progress.hpp"
#include "host/cli/steering.hpp"

namespace lamplock::link {
class LineSender;
}  // namespace lamplock::link

namespace lamplock::cli {

/// Steers one program; sender and progress must outlive it.
class LineSteering {
 public:
  /// `planned_s`: what the program takes, if that is known.
  LineSteering(link::LineSender& sender, Progress& progress, Clocking clocking,
               std::optional<double> planned_s)
      : sender_(sender), progress_(progress), clocking_(clocking), planned_s_(planned_s) {}

  /// To be called after every step of the sender.
  void look();

  /// A door of another's is open: dark, at rest, and the user goes on when it is closed. May be
  /// said again and again.
  void block(const std::string& why);
  /// It is closed.
  void unblock() { obstacle_.clear(); }
  /// It was opened, and nobody has gone on since.
  bool blocked() const { return blocked_; }
  /// Ends the program at once, the position is lost. May be said again and again.
  void end(const std::string& why);

 private:
  using Clock = std::chrono::steady_clock;
  void tell_left();
  void look_at_board();
  void wait_for_user();
  void take_input(std::chrono::milliseconds wait);
  void take_line(const std::string& line);
  void feed(std::uint8_t byte, const std::string& what);
  void go_on();

  link::LineSender& sender_;
  Progress& progress_;
  Clocking clocking_;
  std::optional<double> planned_s_;
  Interrupt interrupt_;
  Keyboard keyboard_;
  bool asking_ = false;  ///< the machine waits until the user says
  bool stopping_ = false;
  bool broken_off_ = false;  ///< by end(), which the user's own stop must not delay
  bool blocked_ = false;
  std::string obstacle_{};                  ///< why nobody may go on now
  std::chrono::microseconds blocked_at_{};  ///< when the board was told last
  Clock::time_point looked_at_{};
  std::chrono::microseconds waiting_since_{}, waited_{0};  ///< by the sender's clock
};

}  // namespace lamplock::cli
