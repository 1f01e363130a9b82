// The user's control of a running program of G-code.
//
// In:  as JobControl; `!` holds, `+`, `-` and `=` change the feed override. Ctrl-C stops.
// Out: requests to the program's sender, notes.
// Who: run_program(), after every step of the sender.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>

#include "host/run/job_control.hpp"
#include "host/run/program_time.hpp"

namespace lamplock::link {
class LineSender;
}  // namespace lamplock::link

namespace lamplock::run {

/// ProgressState::word while a program waits for a tool; the board takes jogs and lines then.
inline constexpr const char* tool_change_word = "tool change";

/// Controls one program; sender, progress, time and frontend must outlive it.
class ProgramControl : public JobControl {
 public:
  ProgramControl(link::LineSender& sender, Frontend& frontend, Progress& progress,
                 Clocking clocking, ProgramTime& time)
      : JobControl(frontend, progress, clocking), sender_(sender), time_(time) {}

  bool waits_for_user() const override { return blocked_; }
  /// It has stopped the program, because a fault has held it and there is no terminal.
  bool lacks_user() const { return lacks_user_; }

 private:
  static constexpr int full_percent = 100;

  void update_progress() override;
  std::string keys() const override;
  ProgressState state() const override;
  void take_interrupts(int count) override;
  int interrupts_to_stop() const override { return 1; }
  void watch_machine() override;
  void take_word(const std::string& word) override;
  void resume_machine() override;
  bool awaits_hold() const override { return is_holding_; }
  bool has_lines_to_send() const override { return !users_lines_.empty(); }
  void send_users_lines();
  void hold_for_obstacle(bool is_new) override;
  void end_machine(bool is_ended) override;
  void take_end_of_input() override;

  void feed(std::uint8_t byte, int percent);
  std::chrono::microseconds machine_time() const;
  double run_s() const;

  link::LineSender& sender_;
  ProgramTime& time_;
  int feed_percent_ = full_percent, rapid_percent_ = full_percent;  ///< overrides, as reported last
  bool blocked_ = false;  ///< an obstacle held the machine, and the user has not resumed since
  bool lacks_user_ = false;
  std::deque<std::string>
      users_lines_;          ///< in a tool change; each after the answer to the one before
  bool is_holding_ = false;  ///< by a key, until the user resumes
  std::chrono::microseconds door_sent_at_{};               ///< of machine_time()
  std::chrono::microseconds waiting_since_{}, waited_{0};  ///< of machine_time()
};

}  // namespace lamplock::run
