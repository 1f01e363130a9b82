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
/// After the host of a job over the pulse stream has died, the board reads its port after 10 s
/// (firmware/boards/rp2040/usb/listener.hpp, job_lease_us).
constexpr Time patience_with_jobs{12'000'000};

/// Reads lines until `take` accepts one; false after `time`, or when the connection breaks.
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

/// Asks with the real-time byte only.
link::BoardStatus ask_status(link::LinePort& port, const std::string& where, Time time) {
  link::BoardStatus status;
  const Time end = port.transport().now() + time;
  while (port.transport().now() < end && port.transport().connected()) {
    port.send_realtime(link::realtime::status);
    const bool reported = listen(port, again, [&](const std::string& line) {
      const auto found = link::parse_status(line);
      if (found) status = *found;
      return found.has_value();
    });
    if (reported) return status;
  }
  if (!port.transport().connected())
    throw Error(Exit::job_failed, where, "its port disappeared before it answered",
                "plug it in again, then flash");
  throw Error(Exit::no_device, where, "does not answer",
              "end other programs that use it (a job may run over its pulse stream), then flash");
}

}  // namespace

std::string version_at_rest(link::Transport& transport, const std::string& where, Asked asked) {
  link::LinePort port(transport);
  const link::BoardStatus status =
      ask_status(port, where, asked == Asked::to_be_sure ? patience_with_jobs : patience);
  // As the firmware judges `$BOOT`: machine/console_commands.cpp.
  if (!status.is("Idle") && !status.is("Alarm"))
    throw Error(Exit::job_failed, where, fmt::format("is not idle ({})", status.state),
                "wait for the end of the job or stop it, then flash");
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
                fmt::format("refuses to enter its boot loader ({})", link::error_text(error)),
                "end its job, then flash");
  // A board that disconnects before its answer has arrived has obeyed.
  if (!answered && transport.connected())
    throw Error(
        Exit::no_device, where, "does not answer $BOOT, which starts its boot loader",
        "end other programs that use its port, or hold BOOTSEL while you plug it in, then flash");
}

std::string version(link::Transport& transport) {
  link::LinePort port(transport);
  return link::greet(port).identity.version;
}

}  // namespace lamplock::flash
