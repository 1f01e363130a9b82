// Sends a program of G-code line by line and monitors it until the machine is at rest.
//
// In:  the lines of a program, a port, the requests of the user (hold, resume, stop, real-time
//      bytes).
// Out: lines and real-time bytes; progress; the result.
// Who: the command line. Not thread-safe.
//
// Characters are counted ("Grbl v1.1 Interface", streaming protocol): a line is sent when it fits
// into the free part of the board's receive buffer, and leaves it with its ok or error. So the
// buffer never overflows, and the board always has the next lines.
//
// A program has ended when two status reports in a row, requested after the last answer, say Idle:
// an ok alone means that the board has parsed a line, not that it has executed it.
//
// In a tool change (M6, state Tool) the user may send lines. Their answers come before those of the
// lines of the program that the board has already received.
//
// When a program ends early - by the user, an error, a fault of the host - the sender holds the
// board (`!`) and resets it (0x18) at rest, which drops the lines in its buffers without losing its
// position. The sender ends only after the board has restarted, or is in alarm.
//
// After the message of an alarm the lines that the board has accepted before may still move the
// machine: the program ends when a status report says that it is in alarm, at rest, or when no
// report comes any more.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "host/link/board_text.hpp"
#include "host/link/dialog.hpp"
#include "host/link/line_port.hpp"
#include "host/link/program_lines.hpp"

namespace lamplock::link {

/// Lines of a program that the host executes itself, while the machine is at rest.
class HostLines {
 public:
  virtual ~HostLines() = default;
  virtual bool has(std::size_t index) const = 0;
  /// The first call begins the line, further ones follow until it returns true. Throws Error if the
  /// line has failed, which stops the program.
  virtual bool run(std::size_t index) = 0;
  /// Ends the line that runs, if one does: the program stops.
  virtual void stop() = 0;
};

/// Time-outs of the sender. All times are times of the transport.
struct LineOptions {
  Patience greeting;
  std::chrono::microseconds status_interval{200'000};   ///< between `?`
  std::chrono::microseconds status_timeout{1'000'000};  ///< until a `?` counts as lost
  std::chrono::microseconds silence_limit{5'000'000};   ///< until the connection counts as cut
  std::chrono::microseconds repeat{500'000};            ///< between `!` or resets without effect
  std::chrono::microseconds stop_timeout{15'000'000};   ///< until the machine must be at rest
  /// Missing answers of an idle board count as lost after this and the dwell times of the lines.
  std::chrono::microseconds answer_timeout{10'000'000};
  bool ignore_errors = false;                       ///< continue after errors
  std::function<void(const std::string&)> on_text;  ///< messages of the board
  HostLines* host_lines = nullptr;                  ///< null: none
};

/// How a program ended.
enum class LineEnd : std::uint8_t {
  done,        ///< every line executed; with ignore_errors there may have been errors
  error,       ///< at the first error
  stopped,     ///< by the user
  alarm,       ///< the board has stopped by itself
  lost,        ///< the connection is lost
  unanswered,  ///< the board is idle, and answers to lines are missing
  restarted,   ///< the board has lost the program by a power loss or a reset
};

/// A line that the board refused.
struct LineError {
  std::size_t line = 0;  ///< number in the file
  int error = 0;
  std::size_t index = 0;  ///< of the lines that are sent
};

/// Result of a program that was begun.
struct LineResult {
  LineEnd end = LineEnd::done;
  std::size_t sent = 0;       ///< lines
  std::size_t answered = 0;   ///< lines
  std::size_t executed = 0;   ///< lines, if the board reports them, else those answered
  std::size_t last_line = 0;  ///< number in the file of the last line accepted; 0 = none
  std::size_t at_line = 0;    ///< number in the file of the last line executed; 0 = not reported
  std::vector<LineError> errors;
  int alarm = 0;       ///< 0 = not reported
  BoardStatus status;  ///< last one received
  std::chrono::microseconds elapsed{0};
};

/// Sends one program. Construct, step() until false, read the result.
class LineSender {
 public:
  /// The port must outlive the sender.
  LineSender(LinePort& port, std::vector<ProgramLine> lines, LineOptions options = {});

  /// One round: read, answer, send, wait a little. False once the program has ended. Throws Error:
  /// no_device (no answer), job_failed (busy, in alarm, no report of rest after a stop), bad_input
  /// (a line does not fit into the board's buffer).
  bool step();

  /// Stops the program because of an error in the caller: steps continue until the machine is at
  /// rest, then step() throws `error`. Throws it at once if no program runs.
  void fail(std::exception_ptr error);

  /// Requests of the user. A hold before the first line keeps the machine at rest until resume().
  void hold();
  void resume();
  void stop();
  /// Resets the board at once, without a hold before: the laser is off before the axes brake, and
  /// axes in motion lose their position. Ends as a stop.
  void break_off();
  /// Sends a line of the user during a tool change, to jog, probe or touch off. False, and nothing
  /// is sent, in another state or while the previous one is not answered.
  bool send_users_line(std::string_view text);
  /// Sends an override or another real-time byte unchanged.
  void realtime(std::uint8_t byte) { port_.send_realtime(byte); }

  /// The board waits for resume(): a pause of the program, a hold, a door.
  bool waits() const;
  /// Number in the file of the line that is answered next; 0 after the last one.
  std::size_t next_line() const;
  /// A line of the host runs.
  bool runs_host_line() const { return host_line_runs_; }
  /// Time of the lines of the host so far.
  std::chrono::microseconds host_time() const;
  /// The board waits, or will wait next, because of M0 or M1.
  bool at_pause() const;

  std::size_t lines() const { return lines_.size(); }
  std::size_t answered() const { return answered_; }
  /// Lines that the board has executed, if it reports them, else lines answered.
  std::size_t executed() const;
  /// Lines that are known to be executed, refused ones included: those before a line that the board
  /// reports, all before and with a line that it executes at rest, and all answered ones as soon as
  /// it is at rest: idle, in a pause, a tool change or a dwell. Steps that were handed out, of 2 to
  /// 3 ms, may follow.
  std::size_t done() const { return done_; }
  const std::vector<LineError>& errors() const { return errors_; }
  const BoardStatus& status() const { return status_; }
  /// Since the first line, by the transport's clock.
  std::chrono::microseconds elapsed() const;
  const Greeting& greeting() const { return greeting_; }
  LineResult result() const;

 private:
  using Time = std::chrono::microseconds;
  enum class Phase : std::uint8_t { greeting, streaming, alarmed, stopping, ended };

  void begin();
  void number_lines();
  void check_lengths() const;

  // Received lines.
  void receive();
  void take(const std::string& line);
  void take_status(BoardStatus status);
  std::size_t index_of(std::size_t number) const;
  bool fresh() const { return status_of_ > asked_before_; }
  bool has_empty_planner() const;
  void note_done_at_rest();
  void take_answer(int error);
  void take_error(int error);
  void take_alarm(int number);
  void take_banner();

  // Sent lines.
  void send_early_hold();
  void poll();
  void fill_window();
  bool is_host_line(std::size_t index) const;
  void run_host_line();
  void stop_host_line();
  bool fits(const std::string& text) const;

  // The end.
  void check_connection();
  void check_end();
  void check_answers();
  Time answers_due() const;
  void await_rest_in_alarm();
  void begin_stop(LineEnd how, std::exception_ptr error = {});
  void insist_on_stop();
  void finish_stop();
  void end(LineEnd how);
  [[noreturn]] void throw_not_stopped();

  LinePort& port_;
  std::vector<ProgramLine> lines_;
  LineOptions options_;
  Greeting greeting_;
  Phase phase_ = Phase::greeting;

  std::size_t sent_ = 0;             ///< lines, counted as in lines_
  std::size_t answered_ = 0;         ///< the same
  std::size_t accepted_ = 0;         ///< the same, up to the last one without an error
  std::size_t bytes_under_way_ = 0;  ///< of lines_[answered_ .. sent_)
  std::size_t at_line_ = 0;          ///< last line that a status named; 0 = none
  std::size_t at_ = 0;               ///< its index
  std::size_t done_ = 0;             ///< lines
  bool is_numbered_ = false;         ///< N words are those of number_lines()
  bool has_index_numbers_ = false;   ///< they are indices in lines_, from 1
  std::vector<LineError> errors_;
  bool users_line_open_ = false;  ///< not answered yet

  BoardStatus status_;
  bool status_open_ = false;        ///< the last `?` is not answered yet
  Time asked_at_{};                 ///< when the last `?` was sent
  std::uint64_t asked_ = 0;         ///< how many `?` were sent
  std::uint64_t status_of_ = 0;     ///< number of the `?` that status_ answers
  std::uint64_t asked_before_ = 0;  ///< `?` before the last answer or request: outdated
  std::uint64_t asked_held_ = 0;    ///< `?` before the last `~`: outdated after a resume
  Time idle_since_{};               ///< the board is idle with answers missing since then
  bool idle_short_ = false;
  bool unlocks_ = false;        ///< the machine was locked, and the first line ends that
  bool is_held_early_ = false;  ///< hold() was called before the first line, and is not sent yet
  int idle_reports_ = 0;
  int still_reports_ = 0;         ///< in a row, before a line that is executed at rest
  std::size_t first_locked_ = 0;  ///< index of the first line on the beat (M130)
  bool host_line_runs_ = false;
  Time host_since_{}, host_time_{};
  Time heard_at_{};
  Time started_at_{}, elapsed_{};

  LineEnd end_ = LineEnd::done;
  LineEnd stop_end_ = LineEnd::stopped;
  std::exception_ptr stop_error_;
  Time stop_by_{}, urged_at_{};  ///< stop_by_: of an alarm, until its next report
  bool held_ = false;   ///< while stopping: a report requested after `!` says that it is at rest
  bool reset_ = false;  ///< while stopping: 0x18 has been sent
  int alarm_ = 0;
};

}  // namespace lamplock::link
