// How a program ends early: the machine is held, and reset at rest (line_sender.hpp).
#include <fmt/format.h>

#include <string>
#include <utility>

#include "host/error.hpp"
#include "host/link/line_sender.hpp"
#include "host/link/not_stopped.hpp"

namespace lamplock::link {
namespace {

/// "Grbl v1.1 Interface", alarms: the target of a motion is outside the work space.
constexpr int alarm_outside = 2;

}  // namespace

/// Begins to stop the machine.
void LineSender::begin_stop(LineEnd how, std::exception_ptr error) {
  phase_ = Phase::stopping;
  stop_end_ = how;
  stop_error_ = std::move(error);
  port_.drop_lines();
  port_.send_realtime(realtime::hold);
  port_.flush();
  stop_host_line();
  const Time now = port_.transport().now();
  urged_at_ = now;
  asked_before_ = asked_;
  stop_by_ = now + options_.stop_timeout;
  if (!status_open_) asked_at_ = now - options_.status_interval;  // ask at once
}

/// Lines that were accepted before the alarm move the machine to their end. Some boards send no
/// report in an alarm.
void LineSender::await_rest_in_alarm() {
  const bool rests = fresh() && (status_.is("Alarm") || status_.rests());
  // This firmware executes the lines before one whose target is outside, so that none is under way.
  if (rests && is_numbered_ && alarm_ == alarm_outside) at_line_ = 0;
  if (rests || port_.transport().now() >= stop_by_) end(LineEnd::alarm);
}

/// Repeats the hold until the machine is at rest, then the reset until it reports a restart.
void LineSender::insist_on_stop() {
  const Time now = port_.transport().now();
  if (status_.is("Alarm") && fresh()) return finish_stop();
  if (now >= stop_by_) throw_not_stopped();
  if (!held_ && status_.is_at_rest() && fresh()) {
    held_ = true;
    urged_at_ = now - options_.repeat;
  }
  if (now - urged_at_ < options_.repeat) return;
  urged_at_ = now;
  port_.send_realtime(held_ ? realtime::reset : realtime::hold);
  reset_ = held_;
}

void LineSender::finish_stop() { end(status_.is("Alarm") ? LineEnd::alarm : stop_end_); }

void LineSender::end(LineEnd how) {
  if (phase_ == Phase::ended) return;
  stop_host_line();
  port_.drop_lines();
  elapsed_ = elapsed();
  end_ = how;
  phase_ = Phase::ended;
}

void LineSender::throw_not_stopped() {
  end(stop_end_);
  const std::string why = errors_.empty() ? ""
                                          : fmt::format(" after line {}, {}", errors_.back().line,
                                                        error_text(errors_.back().error));
  throw NotStopped(
      Exit::job_failed, "machine",
      fmt::format("could not be stopped{}; it may still move and fire; the last line it "
                  "accepted is {}",
                  why, result().last_line),
      "press its emergency stop or switch it off");
}

}  // namespace lamplock::link
