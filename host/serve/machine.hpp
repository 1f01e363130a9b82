// The one thread that talks to the board: status, jogs, lines of the console, jobs.
//
// In:  requests of the server, from its thread; a way to open the board. Out: a view of machine and
//      job, lines of the console.
// Who: the server. All functions return at once; none waits for the board.
//
//   no board --opened--> idle: reports, jogs, lines one after the other <--> job, by a use case of
//   host/run, which borrows the open connection: the board is locked all the time
//
// A board that is unplugged is opened again once a second; it is connected when it reports its
// state. Nothing but questions is sent to it.
//
// A jog needs a lease: run_jog() moves the machine for lease_time at most, and a held key renews
// it. The board has increments for 60 ms only (host/pendant/jog_stream.hpp): if this program is
// stopped or killed, the machine brakes after that time.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "host/geometry/bounds.hpp"
#include "host/link/line_port.hpp"
#include "host/link/transport.hpp"
#include "host/pendant/board_dialog.hpp"
#include "host/pendant/jog_stream.hpp"
#include "host/run/board_options.hpp"
#include "host/run/machine_options.hpp"
#include "host/run/process_choice.hpp"
#include "host/run/supervisor.hpp"
#include "host/serve/clock.hpp"
#include "host/serve/machine_view.hpp"
#include "host/serve/page_frontend.hpp"
#include "shared/inch_axes.hpp"

namespace lamplock::serve {

/// A held key moves the machine this long without a renewal, and then it brakes.
inline constexpr std::chrono::milliseconds lease_time{200};

using BoardOpener = std::function<std::unique_ptr<link::Transport>()>;

/// A job or a program to run.
struct JobStart {
  std::string name;  ///< for users
  std::string path;
  bool is_dry = false;
  bool resumes = false;           ///< the last run of this job
  std::size_t from = 0;           ///< point or line
  run::ProcessChoice material{};  ///< of a program with process parameters; empty: none
};

/// Machine coordinates [mm]; an axis without one stays where it is.
using Place = PerAxis<std::optional<double>>;

/// What the machine does at rest with the port of the board. May throw Error.
using Work = std::function<void(link::LinePort&)>;
/// Called once, in the thread of the machine: the error, or null.
using Done = std::function<void(std::exception_ptr)>;

class Machine {
 public:
  /// `options` name the board in messages and have the lines of the computer.
  Machine(BoardOpener open, run::BoardOptions options, run::MachineOptions machine,
          Now now = Clock::now);
  ~Machine();
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  /// Stops what runs and waits until the machine is at rest. It does nothing more then.
  void end();

  MachineView view() const;
  /// The last job of an earlier server, before any request.
  void show_last(const JobView& job);
  /// A dry run that has begun on the board.
  bool runs_dry_job() const;
  /// Travel of the connected board by its own settings, mm of the machine; nothing before they were
  /// read, and for a board that does not have them.
  std::optional<geometry::Bounds> area() const;
  /// Lines of the console after this number, oldest first; at most max_console_lines.
  std::vector<ConsoleLine> lines_after(std::uint64_t number) const;

  /// Ends a job, a jog or what lines have begun: laser off first, then the machine brakes.
  void stop();
  void hold();
  void resume();
  /// Changes the feed of a program or the speed of a job: "+", "-", or "=" for full.
  void change_feed(const std::string& word);

  // The following throw Error(job_failed) while a job runs or without a board.

  void start(const JobStart& job);
  void post(Work work, Done done);
  /// Sends a line of G-code or a `$` command, after the answer to the one before.
  void send_line(const std::string& line) { send_lines({line}); }
  /// Queues all lines or none. While a program waits for a tool, exactly one line is accepted; its
  /// sender sends it after the answer to the one before.
  void send_lines(const std::vector<std::string>& lines);
  /// Moves for `lease`, at most lease_time. After stop() or bar_jog() a button that is still held
  /// moves nothing: it is refused until release_jog(), or until no request has come for lease_time.
  void run_jog(const pendant::Direction& direction, double feed_mm_min,
               std::chrono::milliseconds lease = lease_time);
  /// In a tool change of a program too.
  void step_jog(int axis, double mm, double feed_mm_min);
  /// Moves to a place along a straight line, from rest, for `lease`; renew_jog() extends it.
  /// Nothing but this call begins a motion, so that a renewal after a stop has no effect. Throws
  /// Error(bad_input) for a place outside of the travel of a board with soft limits.
  void go_to(const Place& place, double feed_mm_min, std::chrono::milliseconds lease = lease_time);
  void renew_jog(std::chrono::milliseconds lease = lease_time);
  void stop_jog();
  /// The jog was stopped by another one than who holds its button.
  void bar_jog();
  /// The button was released.
  void release_jog();
  /// Jobs that have ended since the last call.
  std::vector<EndedJob> take_ended();

 private:
  struct Lease {
    std::optional<pendant::Direction> direction{};
    std::optional<Place> place{};  ///< neither: a renewal of the way to a place
    double feed_mm_min = 0;
    Clock::time_point until{};
  };
  struct Step {
    int axis = 0;
    double mm = 0, feed_mm_min = 0;
  };
  struct Posted {
    Work work;
    Done done;
  };
  class Talk;

  void run();
  void open_board();
  void converse();
  bool round(Talk& talk);
  void take_jogs(Talk& talk);
  void take_lease(Talk& talk, const Lease& lease);
  void lend(Lease lease, std::chrono::milliseconds time);
  void take_stop(Talk& talk);
  void take_answers(Talk& talk);
  void take_command_answer(const pendant::Answered& answer);
  void take_jog_answer(const pendant::Answered& answer);
  void send_next_line(Talk& talk);
  void supervise(Talk& talk);
  void publish(const Talk& talk);
  std::vector<double> in_mm(std::vector<double> place) const;
  void read_limits();
  void do_work(const Posted& posted);
  void run_job(const JobStart& job);
  void run_program(const JobStart& job, PageFrontend& frontend, EndedJob& ended, std::string& end);
  void run_file(const JobStart& job, PageFrontend& frontend, EndedJob& ended, std::string& end);
  run::BoardOptions options_for(const JobStart& job) const;
  void end_job(const std::string& end, const std::string& message, EndedJob ended);
  void lose_board(const std::string& why);
  void show(const std::string& text);
  void show_locked(const std::string& text);
  void check_is_free() const;
  void check_is_not_held(const std::string& what) const;
  void check_can_jog() const;
  bool changes_tool() const;
  void send_in_tool_change(const std::string& line);
  void check_in_area(const Place& place) const;
  void type(const std::string& word);

  BoardOpener open_;
  run::BoardOptions options_;
  run::MachineOptions machine_;
  Now now_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  MachineView view_;
  std::optional<geometry::Bounds> area_;
  std::atomic<bool> has_soft_limits_{false};
  std::deque<ConsoleLine> console_;
  std::uint64_t last_line_ = 0;
  std::deque<Posted> posted_;
  std::vector<EndedJob> ended_;
  std::deque<std::string> lines_;
  std::deque<std::string> words_;  ///< as JobRequests::type() takes them
  std::optional<JobStart> next_job_;
  std::optional<Lease> lease_;
  std::optional<Step> step_;
  std::optional<Clock::time_point> barred_since_;  ///< the last request of a jog that is barred
  std::shared_ptr<JobRequests> requests_;          ///< of the running job
  bool stop_ = false, jog_stop_ = false, ending_ = false;

  // Of the thread of the machine.
  std::unique_ptr<link::Transport> transport_;
  InchAxes inches_{};                         ///< of the positions that the board reports
  std::optional<pendant::JogLimits> limits_;  ///< by the settings of the board; null: to be read
  std::optional<run::Supervisor> supervisor_;
  std::string complaint_;        ///< of the lines of the computer, shown last
  bool is_at_end_ = false;       ///< the last jog was refused at the end of the travel
  bool resets_at_rest_ = false;  ///< a stop of lines: the rest is dropped by a reset
  std::thread thread_;
};

}  // namespace lamplock::serve
