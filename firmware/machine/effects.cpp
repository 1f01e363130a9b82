// What events of the machine cause.
#include "firmware/machine/events.hpp"

namespace lamplock::machine {

void MachineEvents::hold_motion() {
  program_.hold();
  shots_.permit(false, BeatReason::hold);
  // Otherwise a host that queries where to continue would get too low a number.
  runner_.read_outcomes();
  brake_points();
}

void MachineEvents::hold_at_door() {
  brake_points();
  program_.hold();
  shots_.permit(false, BeatReason::door);
  begin_parking();
}

/// Programs park, jobs do not.
void MachineEvents::begin_parking() {
  if (program_.begun() && !machine_.framed() && !beat_locked()) parking_.begin(values_);
}

/// Points stop at once, lines when their planner does.
void MachineEvents::brake_points() {
  if (moving_) runner_.brake();
  moving_ = false;
}

/// A job ends.
void MachineEvents::stop_motion() {
  shots_.permit(false, BeatReason::no_point_due);
  // Shots fired since the last poll count: the next job continues after them.
  if (runner_.begun()) runner_.read_outcomes();
  brake_points();
  runner_.end();
  next_beat_milli_hz_ = 0;
  if (!rows_.runs()) return;
  // On the path, dark from here on.
  rows_.stop();
  stop_lines();
}

/// On their path; lines that are planned are dropped.
void MachineEvents::stop_lines() {
  if (beat_locked()) return brake_points();
  program_.resume();
  program_.cancel();
}

// A constant, because the compiler would count its characters at run time.
constexpr std::string_view stopped_by_host =
    "Stopped by the host: '$X' or reset, then start the program again";

/// Lines that wait are answered with an error and not run.
void MachineEvents::refuse_program() {
  refuse_lines(Refusal::until_unlocked, stopped_by_host);
  drop_open_line();
}

/// Stops on the path, dark.
void MachineEvents::stop_program() {
  refuse_program();
  leave_guarded_motion();
  shots_.permit(false, BeatReason::no_point_due);
  outputs_off();
  stop_lines();
}

/// Called at rest.
void MachineEvents::finish_program() {
  end_program();
  reader_.invalidate_position();
  use_overrides();
}

/// A probe or parking does not continue.
void MachineEvents::leave_guarded_motion() {
  guard_.drop();
  if (parking_.holds_machine()) program_.abort_detour();
  parking_.end();
}

/// Motion ends at once, and the position counts as lost.
void MachineEvents::begin_alarm(bool answers) {
  shots_.permit(false, BeatReason::alarm);
  shots_.beam().cut();
  shots_.end_check();
  // Every shot must be visible when a host queries where to continue.
  if (runner_.begun()) runner_.read_outcomes();
  runner_.halt();
  program_.halt();
  end_program();
  reader_.invalidate_position();
  moving_ = false;
  outputs_off();
  next_beat_milli_hz_ = 0;
  TextLine line;
  line.add("ALARM:").add(std::int64_t{machine_.alarm()}).add("\r\n");
  link_.send_text(line.view());
  guard_.drop();
  parking_.end();
  drop_homing(answers);
  drop_open_line();
  use_overrides();
}

/// The position has changed: a job cannot simply continue.
void MachineEvents::unlock() {
  stop_motion();
  link_.forget_session();
}

/// 0x18 discards typed lines and the rest of a program.
void MachineEvents::begin_reset() {
  leave_guarded_motion();
  program_.end_light();
  reader_.clear();
  lines_at_cancel_ = 0;
  shots_.permit(false, idle_reason());
  outputs_off();
}

/// Called at rest.
void MachineEvents::clear_for_reset() {
  refusal_ = Refusal::none;
  reader_.reset();
  outputs_off();
  reporter_.reset();
  end_overrides_of_program();
  end_program();
  start_up_next_ = 0;
  own_line_ = false;
}

void MachineEvents::cancel_jog() {
  lines_at_cancel_ = reader_.lines();
  if (reader_.drop_line()) answer(GcodeError::none);
  program_.abort_move();
  reader_.invalidate_position();
}

/// Homing ends with an alarm when the machine is at rest.
void MachineEvents::abort_homing_with_alarm(std::uint8_t alarm) {
  guard_.drop();
  homing_.abort(alarm);
  program_.abort_move(true);
}

/// Whatever the racking, only homing moves the sides of a gantry against each other.
void MachineEvents::clear_racking() {
  if (motion_.generator().kinematics().ganged_axis() < 0) return;
  StepPosition steps = steps_at_rest();
  steps[Kinematics::gang_motor] = 0;
  motion_.generator().set_position(steps);
}

/// An alarm was raised. After a reset no answer is expected.
void MachineEvents::drop_homing(bool answers) {
  if (!homing_.active()) return;
  homing_.end();
  clear_racking();
  if (answers) answer(GcodeError::locked);
}

/// After an alarm: the open line is not completed. In a tool change the lines of the user are
/// first.
void MachineEvents::drop_open_line() {
  if (reader_.drop_line() && !own_line_) answer(GcodeError::locked);
  own_line_ = false;
  for (std::uint32_t lines = reader_.drop_tool_change(); lines != 0; --lines)
    answer(GcodeError::locked);
}

/// No further line of a program begins; accepted lines run to their end.
void MachineEvents::refuse_lines(Refusal until, std::string_view reason) {
  if (refusal_ >= until) return;
  refusal_ = until;
  program_outputs_.drop_next();
  if (beat_locked()) runner_.close();
  report_message(reason);
}

/// No line is left, or none continues.
void MachineEvents::end_program() {
  program_.end();
  rows_.end();
  if (!beat_locked()) return;
  reader_.set_lock(program::BeatLock::off);
  runner_.end();
  moving_ = false;
}

/// Switches off all outputs of programs, the laser as well, and drops pending changes: no light
/// before it is requested again. Beat and fill masked.
void MachineEvents::outputs_off() {
  program_outputs_.all_off();
  reader_.switch_off();
  input_wait_.end();
}

/// As in grbl a jog, homing and a probe run at their own feed rate (jog.c, limits.c and gcode.c of
/// grbl 1.1h: PL_COND_FLAG_NO_FEED_OVERRIDE). Before and after each of them the machine is at rest.
/// After M49 none acts; the temperature still scales the feed.
void MachineEvents::use_overrides() {
  const Overrides used = reader_.overrides_off() ? Overrides{} : overrides_;
  const bool own_feed = machine_.jogs() || machine_.homes() || reader_.probing();
  constexpr std::uint8_t full_percent = 100;
  program_.set_overrides(own_feed ? full_percent : loop_feed_percent(used.feed), used.rapid,
                         used.spindle);
  runner_.set_overrides(used.feed, used.rapid);
}

/// The feed override of the user, scaled by the temperature.
std::uint32_t MachineEvents::loop_feed_percent(std::uint32_t percent) const {
  if (loop_.mode(values_) != settings::LoopMode::feed) return percent;
  const std::uint32_t scaled = percent * loop_.percent() / 100;
  return scaled < min_override ? min_override : scaled > max_override ? max_override : scaled;
}

/// Overrides end with the program, as in grbl.
void MachineEvents::end_overrides_of_program() {
  overrides_ = {};
  use_overrides();
}

}  // namespace lamplock::machine
