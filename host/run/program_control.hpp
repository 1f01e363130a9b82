// The user's control of a running program of G-code.
//
// In:  as JobControl; `!` holds, `+`, `-` and `=` change the feed. Ctrl-C stops.
// Out: requests to the program's sender, notes.
// Who: run_program(), after every step of the sender.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "host/run/job_control.hpp"

namespace lamplock::link {
class LineSender;
}  // namespace lamplock::link

namespace lamplock::run {

/// Controls one program; sender, progress and frontend must outlive it.
class ProgramControl : public JobControl {
 public:
  /// `planned_s`: the time of the program, if it is known.
  ProgramControl(link::LineSender& sender, Frontend& frontend, Progress& progress,
                 Clocking clocking, std::optional<double> planned_s)
      : JobControl(frontend, progress, clocking), sender_(sender), planned_s_(planned_s) {}

  bool waits_for_user() const override { return blocked_; }

 private:
  void show_progress() override;
  void take_interrupts(int count) override;
  int interrupts_to_stop() const override { return 1; }
  void watch_machine() override;
  void take_word(const std::string& word) override;
  void resume_machine() override;
  void hold_for_obstacle(bool is_new) override;
  void end_machine(bool is_ended) override;
  void take_end_of_input() override;

  void feed(std::uint8_t byte, const std::string& what);

  link::LineSender& sender_;
  std::optional<double> planned_s_;
  bool blocked_ = false;  ///< an obstacle held the machine, and the user has not resumed since
  std::chrono::microseconds door_sent_at_{};               ///< by the sender's clock
  std::chrono::microseconds waiting_since_{}, waited_{0};  ///< by the sender's clock
};

}  // namespace lamplock::run
