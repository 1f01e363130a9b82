// Sends a job and monitors it until its last shot (docs/wire-format.md, section 2).
//
// In:  a job of points or rows, a transport, the requests of the user (pause, resume, stop, job
// speed). Out: frames; progress; the result of the job. Who: the command line. Not thread-safe,
// except that a signal handler may make requests.
//
// The sender never guesses which frames the machine has: it relies on STATUS alone. A QUERY after
// each burst shows for certain which frames were lost; only these are retransmitted.
//
// When a running job ends early - by the user, a refusal, an error of the host - the sender repeats
// the stop command until STATUS reports that the machine is at rest. Only then it reports the
// reason; if no such STATUS arrives in time, the error says that too.
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
#include "host/link/frame_window.hpp"
#include "host/link/job_result.hpp"
#include "host/link/restart_mark.hpp"
#include "host/link/transport.hpp"
#include "shared/wire/job_header.hpp"
#include "shared/wire/status.hpp"

namespace lamplock::link {

/// Progress of a job, as a journal stores it.
struct JobProgress {
  std::uint32_t session = 0;
  std::uint32_t first_unfired = 0;   ///< all points, or lines, before it are fired
  std::uint32_t may_have_fired = 0;  ///< points from here on are sent after the next report only
};

/// Time-outs of the sender, and where it starts. All times are times of the transport.
struct SenderOptions {
  std::chrono::microseconds hello_timeout{3'000'000};       ///< until the first answer
  std::chrono::microseconds reply_timeout{250'000};         ///< until a QUERY is repeated
  std::chrono::microseconds silence_limit{2'000'000};       ///< until the connection counts as cut
  std::chrono::microseconds reconnect_timeout{60'000'000};  ///< without connection until the end
  std::chrono::microseconds status_interval{100'000};       ///< between QUERYs without losses
  std::size_t window_frames = 16;                           ///< frames sent and not acknowledged
  std::size_t points_ahead = ~std::size_t{0};               ///< at most, sent and not yet fired
  std::size_t first_index = 0;    ///< start at this point or line of the job
  std::size_t run_up_lines = 0;   ///< the first lines are dark and were done in an earlier run
  std::uint32_t first_fired = 0;  ///< flashes of the first point fired in earlier runs
  std::uint32_t session = 0;      ///< 0 = choose at random
  std::uint32_t job_speed = wire::full_job_speed;  ///< percent, set before the first motion
  bool take_over = false;  ///< discard the unfinished job of another session
  /// Resume after `!`, 0x84 and 0x18 that this program did not send: noise of a serial line may be
  /// read as one of them.
  bool auto_resume = false;
  /// Errors say where the job can continue. The machine of an estimate is gone after one.
  bool can_continue = true;
  std::function<void(const std::string&)> on_text;  ///< lines of text from the machine
  /// Called before BEGIN is sent, before points are sent, and at most twice a second while the
  /// machine fires. An exception stops the job.
  std::function<void(const JobProgress&)> on_progress;
};

/// Sends one job. Construct, run(), read the result.
class JobSender {
 public:
  /// Transport and job must outlive the sender. Throws Error(bad_input) if first_index is beyond
  /// the job.
  JobSender(Transport& transport, const job::Job& job, SenderOptions options = {});

  /// Runs the job to its end. Throws Error: no_device (no answer, other version), bad_input (the
  /// machine refuses the job or a point), job_failed (busy, locked, door open, ended by the
  /// machine, or stopped by the user without a report that the machine is at rest).
  JobResult run();

  /// One round: read, answer, send, wait a little. False once the job has ended. Throws as run().
  bool step();

  /// Stops the job because of an error in the caller: steps continue until the machine is at rest,
  /// then step() throws `error`. Throws it at once if no job runs.
  void fail(std::exception_ptr error);

  /// Requests of the user; safe in a signal handler.
  void pause() noexcept { wish_.store(Wish::hold); }
  void resume() noexcept {
    resume_asked_.store(true);
    wish_.store(Wish::run);
  }
  void stop() noexcept { wish_.store(Wish::stop); }
  /// 1 to max_job_speed percent, from now on.
  void set_job_speed(std::uint32_t percent) noexcept { job_speed_.store(percent); }
  std::uint32_t job_speed() const noexcept { return job_speed_.load(); }

  /// All points, or lines, before this index are done.
  std::size_t points_fired() const { return job_status_.first_unfired; }
  JobResult result() const;
  /// The last one received, of any session.
  const wire::Status& status() const { return status_; }
  /// The last one of this job; session 0 until the machine has accepted the job.
  const wire::Status& job_status() const { return job_status_; }
  std::uint32_t session() const { return session_; }
  const job::Job& job() const { return job_; }
  bool auto_resume() const { return options_.auto_resume; }
  /// The machine was silent for options.silence_limit, or the port is gone: the sender tries to
  /// connect again. The status is that of before.
  bool is_cut() const { return cut_; }

 private:
  using Time = std::chrono::microseconds;
  enum class Phase : std::uint8_t { hello, begin, stream, stopping, ended };
  enum class Wish : std::uint8_t { run, hold, stop };
  static_assert(std::atomic<Wish>::is_always_lock_free);
  /// Time until the machine must be at rest after the last shot or a stop.
  static constexpr Time rest_timeout{10'000'000};

  /// A QUERY without answer, and the number of the DATA frame after it.
  struct Barrier {
    std::uint32_t tag;
    std::uint32_t number;
  };

  void advance();

  // Received messages.
  void receive();
  void handle(const wire::Status& status);
  void handle(const RefusedFrame& frame);
  void handle(const std::string& text);
  /// Throws the refusal as an error for the user.
  [[noreturn]] void refuse_job(const wire::Refused& refused) const;
  void throw_ended() const;
  void keep(const wire::Status& status);
  std::uint32_t flashes_fired() const;
  Continuation rest() const;
  std::string advice() const;
  bool take_barrier(const wire::Status& status);

  // Sent frames.
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
  std::size_t end_of_room() const;
  void report_progress(std::size_t may_have_fired);
  void report_progress_in_time();
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

  Transport& transport_;
  const job::Job& job_;
  SenderOptions options_;
  Connection connection_;
  std::uint32_t session_;
  Phase phase_ = Phase::hello;
  JobEnd end_ = JobEnd::lost;
  wire::Status status_;
  wire::Status job_status_;  ///< last one of our session
  std::optional<RestartMark> mark_;
  bool synced_ = false;  ///< a QUERY over this connection was answered
  std::string text_seen_;

  FrameWindow window_;
  std::size_t handed_over_;  ///< end of the points or lines ever written
  JobProgress progress_;     ///< reported last
  Time progress_at_{};

  std::deque<Barrier> barriers_;
  std::uint32_t tag_;
  Time asked_at_{};
  Time heard_at_{};
  Time started_at_{};
  Time begin_at_{};
  Time lost_at_{};  ///< the connection is lost since then
  bool cut_ = false;
  Time reconnect_at_{};
  bool begin_sent_ = false;
  bool taking_over_ = false;

  std::atomic<Wish> wish_{Wish::run};
  std::atomic<bool> resume_asked_{false};
  std::atomic<std::uint32_t> job_speed_;
  std::uint32_t machine_job_speed_ = wire::full_job_speed;  ///< last command
  wire::CommandRequest command_;
  std::uint32_t command_number_ = 0;
  Time command_at_{};
  std::optional<Time> finish_by_;  ///< deadline for rest after the last shot
  int soft_refusals_ = 0;

  JobEnd stop_end_ = JobEnd::stopped;          ///< end of the job once the machine is at rest
  std::exception_ptr stop_error_;              ///< thrown at rest
  bool was_reset_ = false;                     ///< by a byte that this program did not send
  std::optional<wire::Refused> stop_refusal_;  ///< thrown at rest as an error
  Time stop_by_{};                             ///< deadline for rest

  Time elapsed_{};
  std::uint64_t reconnects_ = 0;
};

}  // namespace lamplock::link
