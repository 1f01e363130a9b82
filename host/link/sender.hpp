// Sends a job and sees it through to its last shot (docs/wire-format.md, section 2).
//
// In:  a job of points or rows, a transport, the wishes of the user (pause, resume, stop, job
// speed). Out: frames; progress; at the end how it went. Who: the command line. Not thread-safe but
// for the wishes, which may come from a signal handler.
//
// The sender never guesses what the machine has: what STATUS says is what it has. A QUERY behind
// each burst tells for certain which frames were lost; they are sent again, no others.
//
// Whatever ends a running job early - the user, a refusal, an error of our own - the machine is
// told to stop, again and again, until its STATUS says that it stands. Only then is the reason
// told; if no such STATUS comes in time, the error says that too.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/job/job.hpp"
#include "host/link/connection.hpp"
#include "host/link/continuation.hpp"
#include "host/link/restart_mark.hpp"
#include "host/link/transport.hpp"
#include "shared/wire/status.hpp"

namespace lamplock::link {

/// Job speed, percent of the speed the job was made for.
inline constexpr std::uint32_t full_job_speed = 100;
inline constexpr std::uint32_t highest_job_speed = 140;

/// How far a job is, as a journal has to keep it.
struct JobProgress {
  std::uint32_t session = 0;
  std::uint32_t first_unfired = 0;   ///< all points, or lines, before it are fired
  std::uint32_t may_have_fired = 0;  ///< none from here on is handed to the machine before the next
                                     ///< progress
};

/// How patient the sender is, and where it starts. All times are times of the transport.
struct SenderOptions {
  std::chrono::microseconds hello_timeout{3'000'000};  ///< until the first answer
  std::chrono::microseconds reply_timeout{250'000};    ///< until a question is asked again
  std::chrono::microseconds silence_limit{2'000'000};  ///< until the connection counts as cut
  std::chrono::microseconds give_up{60'000'000};       ///< without connection until the end
  std::chrono::microseconds status_interval{100'000};  ///< between questions when all is well
  std::size_t window_frames = 16;                      ///< frames sent and not acknowledged
  std::size_t points_ahead = ~std::size_t{0};          ///< at most, sent and not yet fired
  std::size_t first_index = 0;                         ///< go on with a job at this point or line
  std::size_t run_up_lines = 0;   ///< the first lines are dark and were done in an earlier run
  std::uint32_t first_fired = 0;  ///< flashes of it fired before, not among those of the job
  std::uint32_t session = 0;      ///< 0 = choose at random
  std::uint32_t job_speed = full_job_speed;  ///< percent, before anything moves
  bool take_over = false;                    ///< give up what is left of another session
  /// Go on after `!`, 0x84 and 0x18 that are not ours: noise of a serial line may be one of them.
  bool auto_resume = false;
  std::function<void(const std::string&)> on_text;  ///< lines of text from the machine
  /// Called before the job is offered to the machine, before points are handed to it, and at most
  /// twice a second while it fires. An exception stops the job.
  std::function<void(const JobProgress&)> on_progress;
};

/// How a job ended.
enum class JobEnd : std::uint8_t {
  done,       ///< every point fired
  stopped,    ///< by the user, here
  alarm,      ///< status.state and status.alarm tell which; e-stop too
  lost,       ///< no connection any more
  restarted,  ///< the machine has forgotten the job: its power or watchdog
  replaced,   ///< the machine has a job of another program
};

/// Result of a job that was begun.
struct JobResult {
  JobEnd end = JobEnd::done;
  wire::Status status;  ///< last one of this job; what another session or a restart shows is not
  std::uint32_t flashes_fired = 0;  ///< of the point status.first_unfired
  Continuation rest;                ///< where to go on
  std::uint64_t resent = 0;         ///< frames sent again
  std::uint64_t bad_frames = 0;     ///< frames from the machine that came in broken
  std::uint64_t reconnects = 0;
  std::chrono::microseconds elapsed{0};
};

/// Sends one job. Construct, run(), read the result.
class JobSender {
 public:
  /// Transport and job must outlive the sender. Throws Error(bad_input) if first_index is beyond
  /// the job.
  JobSender(Transport& transport, const job::Job& job, SenderOptions options = {});

  /// Runs the job to its end. Throws Error: no_device (no answer, other version), bad_input (the
  /// machine refuses the job or a point), job_failed (busy, locked, door open, ended by itself, or
  /// stopped by the user and not heard to stand).
  JobResult run();

  /// One round: read, answer, send, wait a little. False once the job has ended. Throws as run().
  bool step();

  /// Something else has gone wrong while the job was looked after: steps go on until the machine
  /// stands, then step() throws `error`. Thrown at once if there is nothing to stop.
  void fail(std::exception_ptr error);

  /// Wishes of the user; safe in a signal handler.
  void pause() noexcept { wish_.store(Wish::hold); }
  void resume() noexcept {
    resume_asked_.store(true);
    wish_.store(Wish::run);
  }
  void stop() noexcept { wish_.store(Wish::stop); }
  /// 1..highest_job_speed percent, now and until changed.
  void set_job_speed(std::uint32_t percent) noexcept { job_speed_.store(percent); }
  std::uint32_t job_speed() const noexcept { return job_speed_.load(); }

  /// All points, or lines, before this index are done.
  std::size_t points_fired() const { return job_status_.first_unfired; }
  JobResult result() const;
  /// The last one received, whatever session it is of.
  const wire::Status& status() const { return status_; }
  /// The last one of this job; of no session before the machine has taken the job.
  const wire::Status& job_status() const { return job_status_; }
  std::uint32_t session() const { return session_; }
  bool auto_resume() const { return options_.auto_resume; }

 private:
  using Time = std::chrono::microseconds;
  enum class Phase : std::uint8_t { hello, begin, stream, stopping, ended };
  enum class Wish : std::uint8_t { run, hold, stop };
  static_assert(std::atomic<Wish>::is_always_lock_free);

  /// A frame on its way: DATA or END.
  struct Frame {
    std::uint32_t number;
    std::size_t end_index;            ///< after its last point or line
    std::uint64_t end_places;         ///< of the table of runs, with all frames before
    std::vector<std::uint8_t> bytes;  ///< as it goes on the wire
  };
  /// A QUERY on its way and the number of the DATA frame that would have followed it.
  struct Barrier {
    std::uint32_t tag;
    std::uint32_t number;
  };

  void advance();

  // What comes in.
  void receive();
  void handle(const wire::Status& status);
  void handle(const RefusedFrame& frame);
  void handle(const std::string& text);
  void refuse_job(const RefusedFrame& frame) const;
  void throw_ended() const;
  void keep(const wire::Status& status);
  std::uint32_t flashes_fired() const;
  Continuation rest() const;
  std::string advice() const;
  bool take_barrier(const wire::Status& status);
  void acknowledge(const wire::Status& status);

  // What goes out.
  void keep_connected();
  [[noreturn]] void throw_no_answer() const;
  void ask();
  void begin();
  void take_over();
  void steer();
  bool command_taken() const { return status_.last_command >= command_number_; }
  void command(wire::Command command, std::uint32_t value = 0);
  void send_command();
  void stream();
  bool has_room(const Frame& frame) const;
  std::size_t end_of_room() const;
  bool build_frame();
  void tell_progress(std::size_t may_have_fired);
  void tell_progress_in_time();
  void check_end();
  void end(JobEnd how);

  // A job that ends early.
  void begin_stop(JobEnd how, std::exception_ptr error = {});
  void insist_on_stop();
  void finish_stop();
  JobEnd end_of_forgotten() const;
  void throw_reason() const;
  [[noreturn]] void throw_not_stopped();
  Time pause_length() const;

  std::uint32_t next_to_write() const;

  Transport& transport_;
  const job::Job& job_;
  SenderOptions options_;
  Connection connection_;
  job::RecordEncoder encoder_;
  std::uint32_t session_;
  Phase phase_ = Phase::hello;
  JobEnd end_ = JobEnd::lost;  ///< until it has ended otherwise
  wire::Status status_;
  wire::Status job_status_;  ///< last one of our session
  std::optional<RestartMark> mark_;
  bool synced_ = false;  ///< a question asked over this connection was answered
  std::string text_seen_;

  std::deque<Frame> frames_;   ///< built and not acknowledged
  std::uint64_t places_ = 0;   ///< of the table of runs, of all that are acknowledged
  std::size_t cursor_ = 0;     ///< next of them to write
  std::uint32_t built_ = 0;    ///< number of the last frame built
  std::uint32_t written_ = 0;  ///< highest number ever written
  bool end_built_ = false;
  std::size_t frame_points_ = 1;
  std::size_t handed_over_;  ///< behind the last point or line ever written
  JobProgress progress_;     ///< told last
  Time progress_at_{};

  std::deque<Barrier> barriers_;
  std::uint32_t tag_;
  Time asked_at_{};
  Time heard_at_{};
  Time started_at_{};
  Time begin_at_{};
  Time lost_at_{};  ///< since when there is no connection
  bool cut_ = false;
  Time reconnect_at_{};
  bool begin_sent_ = false;
  bool taking_over_ = false;

  std::atomic<Wish> wish_{Wish::run};
  std::atomic<bool> resume_asked_{false};
  std::atomic<std::uint32_t> job_speed_;
  std::uint32_t machine_job_speed_ = full_job_speed;  ///< as commanded last
  wire::CommandRequest command_;
  std::uint32_t command_number_ = 0;
  Time command_at_{};
  std::optional<Time> finish_by_;  ///< all done but the machine still moves
  int soft_refusals_ = 0;

  JobEnd stop_end_ = JobEnd::stopped;         ///< what the job ends with once the machine stands
  std::exception_ptr stop_error_;             ///< what is thrown then,
  bool was_reset_ = false;                    ///< by a byte that is not ours
  std::optional<RefusedFrame> stop_refusal_;  ///< or this, with what the machine says then
  Time stop_by_{};                            ///< until when it has to stand

  Time elapsed_{};
  std::uint64_t resent_ = 0;
  std::uint64_t reconnects_ = 0;
};

}  // namespace lamplock::link
