#include "host/link/dialog.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "host/error.hpp"
#include "host/link/not_ready.hpp"

namespace lamplock::link {
namespace {

using Time = std::chrono::microseconds;

/// Waiting is cut into slices of this length.
constexpr Time slice{5'000};
/// Silence after which all answers have arrived when `$I` was sent more than once.
constexpr Time quiet{300'000};
/// grbl's receive buffer, for boards that do not report theirs.
constexpr std::size_t usual_window_bytes = 127;

double seconds(Time time) { return std::chrono::duration<double>(time).count(); }

/// The beginning of what a board sent, for an error: with another baud rate it is noise.
std::string head_of(const std::string& line) {
  constexpr std::size_t max_bytes = 40;
  return line.size() <= max_bytes ? line : line.substr(0, max_bytes) + "...";
}

/// The next line; empty if none arrives before `until`.
std::optional<std::string> receive_until(LinePort& port, Time until) {
  for (;;) {
    port.flush();
    if (auto line = port.receive()) return line;
    expect_connected(port);
    const Time now = port.transport().now();
    if (now >= until) return std::nullopt;
    port.transport().wait(std::min(slice, until - now));
  }
}

/// One greeting and the answers received so far.
class Asked {
 public:
  Asked(LinePort& port, const Patience& patience) : port_(port), patience_(patience) {}

  Greeting answer() {
    const Time deadline = port_.transport().now() + patience_.timeout;
    while (!complete()) {
      send();
      const Time again = std::min(deadline, port_.transport().now() + patience_.again);
      while (!complete())
        if (const auto line = receive_until(port_, again))
          take(*line);
        else
          break;
      if (!complete() && port_.transport().now() >= deadline) refuse();
    }
    if (asked_ > 1) drain();
    return result();
  }

 private:
  bool complete() const { return answered_ && status_.has_value(); }

  void send() {
    port_.send_realtime(realtime::status);
    port_.send_line("$I");
    ++asked_;
  }

  void take(const std::string& line) {
    if (first_.empty()) first_ = line;
    if (auto status = parse_status(line)) status_ = std::move(status);
    take_identity(line, identity_);
    // An ok before the version answers a line of another program.
    if (parse_answer(line) && !identity_.version.empty()) answered_ = true;
  }

  void drain() {
    while (receive_until(port_, port_.transport().now() + quiet)) {
    }
  }

  Greeting result() const {
    Greeting greeting{identity_, *status_, identity_.window_bytes};
    if (greeting.window_bytes == 0) greeting.window_bytes = usual_window_bytes;
    // grblHAL's $I reports the size of its buffer, which holds one byte less.
    if (status_->rests() && status_->free_bytes && *status_->free_bytes > 0)
      greeting.window_bytes = std::min(greeting.window_bytes, *status_->free_bytes);
    return greeting;
  }

  [[noreturn]] void refuse() const {
    const double s = seconds(patience_.timeout);
    if (first_.empty())
      throw Error(Exit::no_device, "machine", fmt::format("does not answer within {:g} s", s),
                  "check power, cable and the name of the port");
    if (identity_.version.empty() && status_ && !status_->rests()) {
      // A board answers `$I` after the lines that it has accepted before.
      const NotReady reason = why_not_ready(*status_, port_.transport().board(), Homing::unknown);
      throw Error(Exit::job_failed, "machine", reason.what, reason.remedy);
    }
    if (identity_.version.empty())
      throw Error(Exit::no_device, "machine",
                  fmt::format("answers '{}' but reports no version ([VER:]) within {:g} s",
                              head_of(first_), s),
                  "check that it runs lamplock or grbl, its baud rate (--baud), and that no other "
                  "program uses the port");
    throw Error(Exit::no_device, "machine", "does not report its status", "reset it and try again");
  }

  LinePort& port_;
  const Patience& patience_;
  BoardIdentity identity_;
  std::optional<BoardStatus> status_;
  std::string first_;  ///< the first line heard; empty if none
  bool answered_ = false;
  int asked_ = 0;
};

/// A line that a board may send at any time and that is no part of an answer.
bool is_aside(const std::string& line) {
  return line.starts_with("[MSG:") || line.front() == '<' || is_banner(line);
}

/// A held board answers a line only after those before it, but reports its status at once.
std::optional<BoardStatus> status_in_time(LinePort& port) {
  constexpr Time status_timeout{500'000};
  port.send_realtime(realtime::status);
  const Time until = port.transport().now() + status_timeout;
  while (const auto heard = receive_until(port, until))
    if (auto status = parse_status(*heard)) return status;
  return std::nullopt;
}

}  // namespace

void expect_connected(LinePort& port) {
  if (!port.transport().connected())
    throw Error(Exit::no_device, "machine", "the connection broke",
                "check the cable, and that no other program uses the machine");
}

Greeting greet(LinePort& port, const Patience& patience) { return Asked(port, patience).answer(); }

Answer ask(LinePort& port, const std::string& line, const Patience& patience) {
  port.send_line(line);
  Answer answer;
  std::optional<BoardStatus> status;
  Time until = port.transport().now() + patience.timeout;
  while (auto heard = receive_until(port, until)) {
    if (const auto end = parse_answer(*heard)) {
      answer.error = *end;
      return answer;
    }
    if (is_aside(*heard)) {
      if (auto reported = parse_status(*heard)) status = std::move(reported);
      continue;
    }
    until = port.transport().now() + patience.timeout;
    answer.lines.push_back(std::move(*heard));
  }
  if (!status) status = status_in_time(port);
  if (status && !status->rests()) {
    const NotReady reason = why_not_ready(*status, port.transport().board(), Homing::unknown);
    throw Error(Exit::job_failed, "machine", reason.what, reason.remedy);
  }
  const std::string heard = answer.lines.empty()
                                ? ""
                                : fmt::format(", only {} lines that begin with '{}' came",
                                              answer.lines.size(), head_of(answer.lines.front()));
  throw Error(
      Exit::no_device, "machine",
      fmt::format("does not answer '{}' within {:g} s{}", line, seconds(patience.timeout), heard),
      "check the cable, reset the machine and try again");
}

void unlock(LinePort& port) {
  if (greet(port).status.is("Alarm")) ask(port, "$X");
}

}  // namespace lamplock::link
