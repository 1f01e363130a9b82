// The user's control of a running job of points or rows.
//
// In:  as JobControl; a number is the job speed in percent, + and - change it by a step. `!` or the
//      first Ctrl-C holds, the next Ctrl-C stops; without a user who can resume, the first one
//      stops.
// Out: requests to the job's sender, notes.
// Who: run_job(), after every step of the sender.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "host/run/job_control.hpp"
#include "shared/wire/status.hpp"

namespace lamplock::link {
class JobSender;
}  // namespace lamplock::link

namespace lamplock::job {
struct Job;
}  // namespace lamplock::job

namespace lamplock::run {

/// Indices of the pauses among the targets of a job, in order; none of rows.
std::vector<std::size_t> pauses_of(const job::Job& job);

/// Controls one job; sender, progress and frontend must outlive it. The progress counts points or
/// lines, without `pauses`, from pauses_of().
class PointJobControl : public JobControl {
 public:
  PointJobControl(link::JobSender& sender, Frontend& frontend, Progress& progress,
                  Clocking clocking, std::vector<std::size_t> pauses = {})
      : JobControl(frontend, progress, clocking), sender_(sender), pauses_(std::move(pauses)) {}

  bool waits_for_user() const override { return holding_ || asking_ || stopping_; }

 private:
  void update_progress() override;
  std::string keys() const override;
  ProgressState state() const override;
  void take_interrupts(int count) override;
  int interrupts_to_stop() const override {
    return held_by_key_ ? 1 : JobControl::interrupts_to_stop();
  }
  void watch_machine() override;
  void take_word(const std::string& word) override;
  void resume_machine() override;
  void hold_for_obstacle(bool is_new) override;
  void end_machine(bool is_ended) override;
  void take_end_of_input() override;

  void hold();
  void ask_about_hold();
  void ask(const std::string& why);
  void change_job_speed(std::uint32_t percent);
  void stop();
  /// Number of pauses before this target.
  std::size_t pauses_before(std::size_t target) const;

  link::JobSender& sender_;
  std::vector<std::size_t> pauses_;
  bool is_cut_ = false;                                    ///< the user knows of a lost connection
  bool held_by_key_ = false;                               ///< by `!`, not by an interrupt
  wire::HoldReason asked_about_ = wire::HoldReason::none;  ///< of the present hold
};

}  // namespace lamplock::run
