#include "host/run/supervisor.hpp"

#include <fmt/format.h>

#include <utility>

#include "host/error.hpp"
#include "host/gpio/host_lines.hpp"
#include "host/gpio/line_table.hpp"
#include "host/link/not_ready.hpp"

namespace lamplock::run {
namespace {

using gpio::SafetyState;

constexpr std::chrono::milliseconds round{1};
/// An input that is well is quiet after the debounce time; a contact may bounce once more.
constexpr int debounces_to_wait = 3;
/// For one byte to leave.
constexpr std::chrono::milliseconds flush_time{200};

/// Sends a byte and sees it leave.
void send_now(link::LinePort& port, std::uint8_t byte) {
  port.send_realtime(byte);
  link::Transport& transport = port.transport();
  const auto until = transport.now() + flush_time;
  for (port.flush(); port.backlog() > 0 && transport.now() < until; port.flush())
    transport.wait(round);
}

}  // namespace

Supervisor::Supervisor(const BoardOptions& options, link::Transport& transport)
    : transport_(transport) {
  const gpio::LineTable table = options.line_table();
  if (!table.guards()) return;
  lines_ = gpio::host_lines();
  guard_ = std::make_unique<gpio::SafetyInputs>(*lines_, table);
}

Supervisor::Supervisor(std::unique_ptr<gpio::Lines> lines, const gpio::LineTable& table,
                       link::Transport& transport)
    : transport_(transport),
      lines_(std::move(lines)),
      guard_(std::make_unique<gpio::SafetyInputs>(*lines_, table)) {}

void Supervisor::begin(gpio::LaserUse work) {
  if (!guard_) return;
  const auto until = transport_.now() + debounces_to_wait * guard_->debounce() + round;
  for (read_lines(); !guard_->settled() && transport_.now() < until; read_lines())
    transport_.wait(round);
  if (!guard_->settled())
    throw Error(Exit::job_failed, "--lines", guard_->unsettled(),
                "release the e-stop, close the door, and check its wiring with `lamplock lines`");
  guard_->begin(work);
  read_lines();
}

void Supervisor::end() {
  if (guard_) guard_->end();
  guard_.reset();
}

gpio::SafetyState Supervisor::read_lines() { return guard_->poll(transport_.now()); }

void Supervisor::poll(JobControl& control, AtDoor at_door) {
  if (!guard_) return;
  const SafetyState state = read_lines();
  if (state == SafetyState::stop || (state == SafetyState::door && at_door == AtDoor::ends)) {
    if (ended_by_.empty()) ended_by_ = guard_->reason();
    control.end(ended_by_);
  } else if (state == SafetyState::door) {
    door_was_open_ = true;
    control.block(guard_->reason());
  } else {
    control.unblock();
    if (door_was_open_ && !control.waits_for_user()) resume_after_door();
  }
}

/// The interlock is on before the machine receives the resume.
void Supervisor::resume_after_door() {
  door_was_open_ = false;
  guard_->resume();
  read_lines();
}

void Supervisor::poll(link::LinePort& port) {
  if (!guard_) return;
  const SafetyState state = read_lines();
  if (state == SafetyState::clear) return;
  ended_by_ = guard_->reason();
  const bool door = state == SafetyState::door;
  // A line that was queued in this round must not follow the byte.
  if (door)
    port.drop_unbegun_lines();
  else
    port.drop_lines();
  send_now(port, door ? link::realtime::door : link::realtime::reset);
  throw_stopped(ended_by_, door ? "the machine holds" : "the machine was reset",
                door ? "close it, then " + link::way_to_resume(port.transport().board())
                     : "release it, then " +
                           link::way_to_unlock(port.transport().board(), link::Homing::unknown));
}

void throw_stopped(const std::string& ended_by, const std::string& reach,
                   const std::string& remedy) {
  throw Error(Exit::job_failed, "--lines", fmt::format("{}: {}", ended_by, reach), remedy);
}

}  // namespace lamplock::run
