// Commands of the sender to the machine: another job's stop, hold, resume, job speed.
#include <array>

#include "host/link/not_stopped.hpp"
#include "host/link/sender.hpp"

namespace lamplock::link {

/// Stops the unfinished job of another session; BEGIN is repeated until the machine accepts it.
void JobSender::take_over() {
  const Time now = transport_.now();
  if (!taking_over_) finish_by_ = now + rest_timeout;
  taking_over_ = true;
  if (now > *finish_by_)
    throw NotStopped(Exit::job_failed, "machine", "the other job does not stop",
                     "reset the machine");
  const std::array payload{static_cast<std::uint8_t>(wire::Command::stop)};
  connection_.send({wire::FrameType::command, status_.session, status_.last_command + 1}, payload);
}

/// Sends the commands that the user's requests need.
void JobSender::steer() {
  if (wish_ == Wish::stop) return begin_stop(JobEnd::stopped);
  if (cut_ || !synced_) return;
  const Time now = transport_.now();
  const bool taken = command_taken();
  const bool other_speed = taken && job_speed_ != machine_job_speed_;
  if (!other_speed &&
      now - command_at_ < (taken ? options_.status_interval : options_.reply_timeout) &&
      command_number_ > 0)
    return;
  if (!taken) return send_command();
  const bool held = status_.state == wire::MachineState::hold;
  // A hold for another reason may end without a command of the host; a hold by the host does not.
  const bool firmly_held = held && status_.hold_reason == wire::HoldReason::host;
  if (wish_ == Wish::hold && !firmly_held && (held || status_.state == wire::MachineState::run))
    return command(wire::Command::hold);
  if (job_speed_ != machine_job_speed_) {
    machine_job_speed_ = job_speed_;
    return command(wire::Command::job_speed, machine_job_speed_);
  }
  if (wish_ != Wish::run) return;
  // A request to resume does not apply to a later hold.
  if (status_.state == wire::MachineState::run) resume_asked_.store(false);
  // A hold caused by the host's own silence is resumed. Every other hold is ended by the user: one
  // for a missed shot, one by a typed byte, and that of a door, which leaves a firm hold when it
  // closes.
  const bool door = status_.state == wire::MachineState::door;
  const bool by_byte = status_.hold_reason == wire::HoldReason::realtime ||
                       status_.hold_reason == wire::HoldReason::reset;
  const bool over =
      status_.hold_reason == wire::HoldReason::dead_man || (by_byte && options_.auto_resume);
  if (held && status_.hold_reason == wire::HoldReason::reset && !over) {
    was_reset_ = true;
    return begin_stop(JobEnd::stopped);
  }
  if ((held && over) || ((held || door) && resume_asked_.load())) {
    resume_asked_.store(false);
    command(wire::Command::resume);
  }
}

void JobSender::command(wire::Command what, std::uint32_t value) {
  command_ = {what, value};
  ++command_number_;
  send_command();
}

void JobSender::send_command() {
  std::array<std::uint8_t, wire::max_command_size> payload{};
  wire::ByteWriter out(payload);
  wire::write_command(out, command_);
  connection_.send({wire::FrameType::command, session_, command_number_}, out.written());
  command_at_ = transport_.now();
}

}  // namespace lamplock::link
