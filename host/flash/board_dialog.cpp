#include "host/flash/board_dialog.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>

#include "host/error.hpp"
#include "host/link/board_text.hpp"
#include "host/link/dialog.hpp"
#include "host/link/line_port.hpp"

namespace lamplock::flash {
namespace {

using Time = std::chrono::microseconds;

constexpr Time slice{5'000}, again{500'000}, patience{3'000'000};
/// Once the host of a job over the pulse stream has died, the port is heard after 10 s
/// (firmware/boards/rp2040/usb/listener.hpp, job_lease_us).
constexpr Time patience_with_jobs{12'000'000};

/// Lines until one is taken; false after `time`, or when the connection breaks.
bool listen(link::LinePort& port, Time time, const std::function<bool(const std::string&)>& take) {
  link::Transport& transport = port.transport();
  const Time end = transport.now() + time;
  while (transport.connected()) {
    port.flush();
    while (const auto line = port.receive())
      if (take(*line)) return true;
    const Time now = transport.now();
    if (now >= end) return false;
    transport.wait(std::min(slice, end - now));
  }
  return false;
}

/// By the real-time byte alone.
link::BoardStatus ask_status(link::LinePort& port, const std::string& where, Time time) {
  link::BoardStatus status;
  const Time end = port.transport().now() + time;
  while (port.transport().now() < end && port.transport().connected()) {
    port.send_realtime(link::realtime::status);
    const bool told = listen(port, again, [&](const std::string& line) {
      const auto found = link::parse_status(line);
      if (found) status = *found;
      return found.has_value();
    });
    if (told) return status;
  }
  if (!port.transport().connected())
    throw Error(Exit::job_failed, where, "its port has gone while it was asked",
                "plug it in again, then flash");
  throw Error(Exit::no_device, where, "does not answer",
              "end other programs that use it (over its pulse stream a job may run), then flash");
}

}  // namespace

std::string version_at_rest(link::Transport& transport, const std::string& where, Asked asked) {
  link::LinePort port(transport);
  const link::BoardStatus status =
      ask_status(port, where, asked == Asked::to_be_sure ? patience_with_jobs : patience);
  // As the firmware judges `$BOOT`: machine/controller_text.cpp.
  if (!status.is("Idle") && !status.is("Alarm"))
    throw Error(Exit::job_failed, where, fmt::format("is not at rest ({})", status.state),
                "end the job, then flash");
  return link::greet(port).identity.version;
}

void enter_boot_loader(link::Transport& transport, const std::string& where) {
  link::LinePort port(transport);
  port.send_line("$BOOT");
  int error = 0;
  const bool answered = listen(port, patience, [&](const std::string& line) {
    const auto answer = link::parse_answer(line);
    error = answer.value_or(0);
    return answer.has_value();
  });
  if (error != 0)
    throw Error(Exit::job_failed, where,
                fmt::format("does not leave for its boot loader ({})", link::error_text(error)),
                "end what it does, then flash");
  // Gone before its answer has come: that is an answer too.
  if (!answered && transport.connected())
    throw Error(Exit::no_device, where, "does not answer $BOOT",
                "end other programs that use its port, then flash");
}

std::string version(link::Transport& transport) {
  link::LinePort port(transport);
  return link::greet(port).identity.version;
}

}  // namespace lamplock::flash
