// Real-time bytes: overrides, coolant, the end of a jog, resets.
#include "firmware/machine/controller.hpp"
#include "shared/wire/realtime_inbox.hpp"

namespace lamplock::machine {
namespace {

using wire::HoldReason;
using wire::MachineState;

// Real-time bytes of grbl 1.1, besides those of shared/wire/realtime_inbox.hpp.
constexpr std::uint8_t byte_feed_full = 0x90;     // then +10, -10, +1, -1
constexpr std::uint8_t byte_rapid_full = 0x95;    // then 50 %, 25 %
constexpr std::uint8_t byte_spindle_full = 0x99;  // then as for the feed
constexpr std::uint8_t byte_flood = 0xa0, byte_mist = 0xa1;

constexpr std::uint8_t full_percent = 100;
constexpr int least_override = 10, most_override = 200;
constexpr std::array<std::uint8_t, 3> rapid_percents{100, 50, 25};
constexpr std::array<int, 5> override_changes{0, 10, -10, 1, -1};

}  // namespace

/// Overrides end with the program, as in grbl.
void Controller::end_overrides_of_program() {
  overrides_ = {};
  use_overrides();
}

/// As in grbl a jog, homing and a probe run at their own feed rate (jog.c, limits.c and gcode.c of
/// grbl 1.1h: PL_COND_FLAG_NO_FEED_OVERRIDE). Before and after each of them the machine is at rest.
void Controller::use_overrides() {
  const bool own_feed = jogging_ || homing_.active() || reader_.probing();
  program_.set_overrides(own_feed ? full_percent : overrides_.feed, overrides_.rapid,
                         overrides_.spindle);
  runner_.set_overrides(overrides_.feed, overrides_.rapid);
}

void Controller::cancel_jog() {
  lines_at_cancel_ = reader_.lines();
  if (reader_.drop_line()) answer(GcodeError::none);
  program_.abort_move();
  reader_.invalidate_position();
}

/// 0x18. Discards typed lines and the rest of a program; motion first stops on its path.
void Controller::reset() {
  link_.drop_input();
  if (framed_job() && job_unfinished()) return reset_job();
  guard_.drop();
  if (parking_.holds_machine()) program_.abort_detour();
  parking_.end();
  const bool moves = !motion_.at_rest();
  reader_.clear();
  lines_at_cancel_ = 0;
  shots_.permit(false, idle_reason());
  outputs_off();
  reset_due_ = true;
  if (homing_.active()) return fail_homing(alarm_homing_reset);
  // A stopped job only has to come to rest.
  if ((!program_.begun() && !beat_locked()) || rows_.active() || !moves) return settle_program();
  if (beat_locked()) {
    if (moving_) runner_.brake();
    moving_ = false;
  } else if (jogging_) {
    program_.abort_move();
  } else {
    program_.resume();
    program_.cancel();
  }
  state_ = MachineState::run;
  moved_at_reset_ = true;
}

/// A job is dark at once. A job of points is held; its host stops it, or resumes it if the byte may
/// have been noise (--auto-resume). A job of rows ends, and so does a job without a host; the board
/// still knows where it can continue.
void Controller::reset_job() {
  refusal_ = Refusal::none;
  const bool held = state_ == MachineState::hold;
  if (wire_job() && host_lives() && (held || state_ == MachineState::run)) {
    hold(HoldReason::reset);
    hold_reason_ = HoldReason::reset;
    return;
  }
  stop();
  hold_reason_ = HoldReason::reset;
  say("Job ended by a reset");
}

/// Called at rest.
void Controller::finish_reset() {
  const bool lost = moved_at_reset_ || asleep_;
  reset_due_ = moved_at_reset_ = asleep_ = jogging_ = check_ = stopping_ = false;
  refusal_ = Refusal::none;
  reader_.reset();
  outputs_off();
  reporter_.reset();
  end_overrides_of_program();
  if (job_unfinished()) state_ = MachineState::idle;
  hold_reason_ = HoldReason::none;
  end_program();
  if (lost && state_ == MachineState::idle) raise_alarm(alarm_position_lost);
  start_up_next_ = 0;
  own_line_ = false;
  send_banner();
  if (state_ == MachineState::alarm) say("'$H'|'$X' to unlock");
}

void Controller::change_override(std::uint8_t& percent, int by) {
  const int changed = by == 0 ? full_percent : percent + by;
  percent = static_cast<std::uint8_t>(changed < least_override  ? least_override
                                      : changed > most_override ? most_override
                                                                : changed);
}

void Controller::override_byte(std::uint8_t byte) {
  const std::size_t feed = byte - std::size_t{byte_feed_full};
  const std::size_t rapid = byte - std::size_t{byte_rapid_full};
  const std::size_t spindle = byte - std::size_t{byte_spindle_full};
  if (feed < override_changes.size())
    change_override(overrides_.feed, override_changes[feed]);
  else if (rapid < rapid_percents.size())
    overrides_.rapid = rapid_percents[rapid];
  else if (spindle < override_changes.size())
    change_override(overrides_.spindle, override_changes[spindle]);
  else
    return;
  use_overrides();
}

/// Switches flood and mist manually in the states where grbl does; false for any other byte.
bool Controller::toggle_coolant(std::uint8_t byte) {
  if (byte != byte_flood && byte != byte_mist) return false;
  const bool may =
      state_ == MachineState::idle || state_ == MachineState::run || state_ == MachineState::hold;
  if (!may || framed_job() || check_ || asleep_) return true;
  if (byte == byte_flood)
    reader_.toggle_flood();
  else
    reader_.toggle_mist();
  return true;
}

void Controller::on_realtime(std::uint8_t byte) {
  if (byte == wire::byte_status) {
    status_line_due_ = true;
    return;
  }
  const Masked masked(mask_);
  switch (byte) {
    case wire::byte_door:
      // In a job it may be one flipped bit.
      if (!framed_job() && state_ != MachineState::idle) {
        open_door();
        break;
      }
      [[fallthrough]];
    case wire::byte_hold:
      hold(HoldReason::realtime);
      break;
    case wire::byte_resume:
      // A job continues under the control of its host, which ends its own holds by a frame.
      if (!framed_job() || (hold_reason_ != HoldReason::host && host_lives()))
        resume();
      else if (!host_lives() && state_ != MachineState::run)
        say("No host: 0x18 ends the job");
      break;
    case wire::byte_reset:
      reset();
      break;
    case wire::byte_jog_cancel:
      if (jogging_)
        cancel_jog();
      else if (state_ == MachineState::home || parking_.holds_machine())
        hold(HoldReason::realtime);
      else
        lines_at_cancel_ = reader_.lines();  // jogs that wait are dropped
      break;
    default:
      if (!toggle_coolant(byte)) override_byte(byte);
      break;
  }
}

}  // namespace lamplock::machine
