// Jobs that end early: the sender repeats the stop until the machine is at rest, then gives the
// reason.
#include <fmt/format.h>

#include <utility>

#include "host/error.hpp"
#include "host/link/not_stopped.hpp"
#include "host/link/sender.hpp"

namespace lamplock::link {

void JobSender::fail(std::exception_ptr error) {
  if (phase_ == Phase::stream) return begin_stop(JobEnd::stopped, std::move(error));
  if (phase_ != Phase::stopping) std::rethrow_exception(error);
  if (!stop_error_) stop_error_ = std::move(error);
}

/// Stops the machine. At rest the job ends with `how`, or `error` is thrown.
void JobSender::begin_stop(JobEnd how, std::exception_ptr error) {
  phase_ = Phase::stopping;
  stop_end_ = how;
  stop_error_ = std::move(error);
  stop_by_ = transport_.now() + rest_timeout;
  command(wire::Command::stop);
}

/// Repeats a stop that was not acknowledged: the machine executes it once.
void JobSender::insist_on_stop() {
  const Time now = transport_.now();
  if (is_at_rest(status_.state) || status_.session != session_) return finish_stop();
  if (now >= stop_by_) throw_not_stopped();
  if (!cut_ && !command_taken() && now - command_at_ >= options_.reply_timeout) send_command();
}

/// Why the machine no longer has a job of this session: without a restart, another job replaced it.
JobEnd JobSender::end_of_forgotten() const {
  return status_.session == 0 || mark_ ? JobEnd::restarted : JobEnd::replaced;
}

void JobSender::finish_stop() {
  using wire::MachineState;
  const bool ours = status_.session == session_;
  const bool idle = status_.state == MachineState::idle;
  if (ours && idle && status_.first_unfired >= job_.size())
    end(JobEnd::done);
  else
    end(!ours ? end_of_forgotten() : idle ? stop_end_ : JobEnd::alarm);
  throw_reason();
}

/// Throws the error that ended the job early, if any.
void JobSender::throw_reason() const {
  if (stop_refusal_) refuse_job(*stop_refusal_);
  if (stop_error_) std::rethrow_exception(stop_error_);
  if (was_reset_ && end_ == JobEnd::stopped)
    throw Error(Exit::job_failed, "machine", "was stopped by a reset (0x18), not by this program",
                advice());
}

/// Throws an error that contains the first one, if any.
void JobSender::throw_not_stopped() {
  end(stop_end_);
  const std::string where = "machine", what = "could not be stopped, it may still move and fire",
                    remedy = "press its emergency stop or switch it off";
  try {
    throw_reason();
  } catch (const Error& error) {
    throw NotStopped(Exit::job_failed, where, fmt::format("{} after '{}'", what, error.message()),
                     remedy);
  } catch (const std::exception& error) {
    throw NotStopped(Exit::job_failed, where, fmt::format("{} after '{}'", what, error.what()),
                     remedy);
  }
  throw NotStopped(Exit::job_failed, where, what,
                   fmt::format("{}; all {}s before {} are done, maybe more; then {}", remedy,
                               job_.item(), job_status_.first_unfired, advice()));
}

}  // namespace lamplock::link
