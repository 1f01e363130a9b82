// The user's hand on a running job: Ctrl-C, Enter, another job speed.
//
// In:  interrupts, lines on stdin, the state of the machine, what the lines of the computer say.
//      Out: wishes to the sender, notes.
//      A blank line goes on after a hold; a number is the job speed in percent, + and - change it
//      by a step. Unless it waits for an answer only a terminal is read: a script that feeds itself
//      by stdin keeps its lines.
// Who: run_job, after every step of the sender.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "host/cli/interrupt.hpp"
#include "host/cli/keyboard.hpp"
#include "host/cli/progress.hpp"
#include "shared/wire/status.hpp"

namespace lamplock::link {
class JobSender;
}  // namespace lamplock::link

namespace lamplock::cli {

/// Whose time it is while the user thinks.
enum class Clocking {
  wall,      ///< the machine's: it runs on
  lock_step  ///< ours: a simulated board stands still while we wait
};

/// Steers one job; all arguments must outlive it.
class Steering {
 public:
  Steering(link::JobSender& sender, Progress& progress, Clocking clocking)
      : sender_(sender), progress_(progress), clocking_(clocking) {}

  /// To be called after every step of the sender.
  void look();
  /// The user holds the machine, or has to say that it may go on: nobody else does.
  bool user_decides() const { return holding_ || asking_ || stopping_; }

  /// Something else than the user holds the machine; the user may go on when it is over. May be
  /// said again and again.
  void block(const std::string& why);
  /// What blocked it is over.
  void unblock() { obstacle_.clear(); }
  /// Ends the job for another reason than the user's. May be said again and again.
  void end(const std::string& why);

 private:
  void ask_about_hold();
  void end_question();
  void ask_to_go_on(const std::string& why);
  void wait_for_user();
  void take_input(std::chrono::milliseconds wait);
  void take_line(const std::string& line);
  void change_job_speed(std::uint32_t percent);
  void stop();
  void go_on();

  link::JobSender& sender_;
  Progress& progress_;
  Clocking clocking_;
  Interrupt interrupt_;
  bool holding_ = false;  ///< the user wants a hold
  bool asking_ = false;   ///< the machine is at rest until the user says
  wire::HoldReason asked_about_ = wire::HoldReason::none;  ///< of the present hold
  bool stopping_ = false;
  std::string obstacle_{};  ///< why nobody may go on now
  Keyboard keyboard_;
  std::chrono::steady_clock::time_point looked_at_{};
  std::optional<std::chrono::steady_clock::time_point> asked_at_{};
};

}  // namespace lamplock::cli
