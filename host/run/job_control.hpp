// What the user, and the supervisor, do to a running job or program: hold, resume, speed, stop.
//
// In:  interrupts, typed lines, the state of the machine; obstacles that the supervisor reports.
// Out: requests to the sender, notes for the user.
// Who: run_job() and run_program(), after every step of the sender.
//
// A blank line or `~` resumes after a hold. A file or a pipe is read only while the machine waits
// for an answer: a script that feeds itself by stdin keeps its lines. An interrupt never waits for
// an answer of such an input: it stops the machine.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "host/run/frontend.hpp"

namespace lamplock::run {

/// ProgressState::word of a job or program that a user resumes, and at a pause in it.
inline constexpr const char *held_word = "held", *pause_word = "pause";

/// Whose time passes while the user thinks.
enum class Clocking {
  wall,      ///< the machine's: it runs on
  lock_step  ///< ours: a simulated board makes no progress while the host waits
};

/// What is common to jobs (point_job_control.hpp) and programs of G-code (program_control.hpp).
class JobControl {
 public:
  JobControl(Frontend& frontend, Progress& progress, Clocking clocking)
      : progress_(progress),
        clocking_(clocking),
        interrupts_(frontend.interrupts()),
        input_(frontend.line_input()) {}
  virtual ~JobControl() = default;
  JobControl(const JobControl&) = delete;
  JobControl& operator=(const JobControl&) = delete;

  /// To be called after every step of the sender.
  void poll();

  /// Holds the machine for an obstacle, such as an open door, that forbids to resume. May be called
  /// again and again.
  void block(const std::string& why);
  /// The obstacle is gone: the user may resume.
  void unblock() { obstacle_.clear(); }
  /// Ends the job for a reason that is not the user's. May be called again and again.
  void end(const std::string& why);
  /// The machine is held until the user resumes.
  virtual bool waits_for_user() const = 0;

 protected:
  using Clock = std::chrono::steady_clock;

  virtual void update_progress() = 0;
  /// Interrupts since the user resumed last; holds or stops.
  virtual void take_interrupts(int count) = 0;
  /// So many interrupts stop the machine; without a user who can resume, the first one does.
  virtual int interrupts_to_stop() const { return can_answer() ? 2 : 1; }
  /// Asks the user, or ends the question, by the state of the machine.
  virtual void watch_machine() = 0;
  /// A typed word that is not a resume.
  virtual void take_word(const std::string& word) = 0;
  virtual void resume_machine() = 0;
  /// A hold was requested, and the machine is not at rest yet.
  virtual bool awaits_hold() const { return false; }
  /// Lines of the user wait for the board: the machine is resumed after them.
  virtual bool has_lines_to_send() const { return false; }
  virtual void hold_for_obstacle(bool is_new) = 0;
  virtual void end_machine(bool is_ended) = 0;
  /// A simulated machine waits for an answer, and the input has ended.
  virtual void take_end_of_input() = 0;

  void note(const std::string& text) { progress_.note(text); }
  void resume();
  /// A user can type an answer. An input that is not typed is not a user.
  bool can_answer() const { return input_->is_typed() && !input_->ended(); }
  /// Shows a question, and how to answer it: `keys` by keys of the terminal.
  void ask_user(const std::string& question, const std::string& keys);
  /// The keys of the terminal, in one line.
  virtual std::string keys() const = 0;
  /// What the machine does, and its speed, for the progress; empty while it works at full speed.
  virtual ProgressState state() const = 0;

  Progress& progress_;
  Clocking clocking_;
  std::unique_ptr<Interrupts> interrupts_;
  bool asking_ = false;   ///< the machine is at rest until the user answers
  bool holding_ = false;  ///< the user or an obstacle holds the machine
  bool stopping_ = false;
  std::string obstacle_{};  ///< why the user cannot resume now

 private:
  void show_keys();
  void show_progress();
  void wait_for_user();
  void take_input(std::chrono::milliseconds wait);
  void take_line(const std::string& line);

  std::unique_ptr<LineInput> input_;
  bool ended_ = false;            ///< by end()
  bool resumes_at_rest_ = false;  ///< the user has resumed while the machine braked for the hold
  Clock::time_point polled_at_{};
  Clock::time_point begun_at_ = Clock::now();
  bool keys_shown_ = false;
};

}  // namespace lamplock::run
