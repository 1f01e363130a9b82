// What the controller does for the events of the machine (machine.hpp).
#include "firmware/machine/controller.hpp"

namespace lamplock::machine {

using wire::HoldReason;

Conditions Controller::conditions() const {
  unsigned now = 0;
  if (door_open()) now |= door_is_open;
  if (host_lives()) now |= job_host_lives;
  if (!motion_.at_rest()) now |= is_moving;
  if (parking_.stage() != Parking::Stage::off) now |= tool_is_away;
  if (program_.begun()) now |= lines_have_begun;
  return static_cast<Conditions>(now);
}

// Called with beat and fill interrupts masked, as all that it causes.
void Controller::handle(Event event, std::uint8_t detail) {
  perform(machine_.apply(event, conditions(), detail));
}

void Controller::perform(Effect effect) {
  switch (effect) {
    case Effect::none:
      break;
    case Effect::hold_motion:
      hold_motion();
      break;
    case Effect::hold_at_door:
      hold_at_door();
      break;
    case Effect::hold_program_at_door:
      program_.hold();
      say("Check Door");
      break;
    case Effect::keep_parked:
      if (parking_.cancel_return()) program_.abort_detour();
      break;
    case Effect::hold_parking:
      if (!parking_.holds_machine()) break;
      parking_.stay_here();
      program_.abort_detour();
      break;
    case Effect::return_tool:
      parking_.request_return();
      break;
    case Effect::resume_motion:
      program_.resume();
      reader_.go_on();
      break;
    case Effect::drop_jogs:
      lines_at_cancel_ = reader_.lines();
      break;
    case Effect::begin_check:
      say("Enabled");
      break;
    case Effect::end_check:
      say("Disabled");
      reader_.reset();
      greet();
      break;
    case Effect::switch_off:
      say("Sleeping");
      outputs_off();
      break;
    default:
      perform_end(effect);
      break;
  }
}

/// Effects that end an activity, or begin to.
void Controller::perform_end(Effect effect) {
  switch (effect) {
    case Effect::cancel_jog:
      return cancel_jog();
    case Effect::stop_job:
      return stop_motion();
    case Effect::end_job:
      stop_motion();
      return say("Job ended by a reset");
    case Effect::stop_program:
      return stop_program();
    case Effect::refuse_program:
      return refuse_program();
    case Effect::break_off_homing:
      return break_off_homing(alarm_homing_reset);
    case Effect::break_off_homing_at_door:
      return break_off_homing(alarm_homing_door);
    case Effect::unlock:
      return unlock();
    case Effect::raise_alarm:
      return begin_alarm(true);
    case Effect::release_estop:
      return say(unlock_text);
    case Effect::begin_reset:
      return begin_reset();
    case Effect::abort_program:
      begin_reset();
      return stop_lines();
    case Effect::abort_jog:
      begin_reset();
      return program_.abort_move();
    case Effect::abort_homing:
      begin_reset();
      return break_off_homing(alarm_homing_reset);
    case Effect::finish_job:
      // The edge may have occurred since prepare(): with state idle every shot must be visible.
      return runner_.read_outcomes();
    case Effect::finish_rows:
      end_program();
      return end_overrides_of_program();
    case Effect::finish_program:
      return finish_program();
    case Effect::finish_jog:
      return use_overrides();
    case Effect::reset_at_rest:
      begin_reset();
      [[fallthrough]];
    case Effect::finish_reset:
      clear_for_reset();
      return greet();
    case Effect::finish_abort:
      clear_for_reset();
      begin_alarm(false);
      return greet();
    default:
      return;
  }
}

void Controller::hold_motion() {
  program_.hold();
  shots_.permit(false, BeatReason::hold);
  // Otherwise a host that queries where to continue would get too low a number.
  runner_.read_outcomes();
  brake_points();
}

void Controller::hold_at_door() {
  brake_points();
  program_.hold();
  shots_.permit(false, BeatReason::door);
  begin_parking();
}

/// Points stop at once, lines when their planner does.
void Controller::brake_points() {
  if (moving_) runner_.brake();
  moving_ = false;
}

/// A job ends.
void Controller::stop_motion() {
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
void Controller::stop_lines() {
  if (beat_locked()) return brake_points();
  program_.resume();
  program_.cancel();
}

// A constant, because the compiler would count its characters at run time.
constexpr std::string_view stopped_by_host = "Stopped by the host: '$X' or reset to continue";

/// Lines that wait are answered with an error and not run.
void Controller::refuse_program() {
  refuse_lines(Refusal::until_unlocked, stopped_by_host);
  drop_open_line();
}

/// Stops on the path, dark.
void Controller::stop_program() {
  refuse_program();
  leave_guarded_motion();
  shots_.permit(false, BeatReason::no_point_due);
  outputs_off();
  stop_lines();
}

/// Called at rest.
void Controller::finish_program() {
  end_program();
  reader_.invalidate_position();
  use_overrides();
}

/// A probe or parking does not continue.
void Controller::leave_guarded_motion() {
  guard_.drop();
  if (parking_.holds_machine()) program_.abort_detour();
  parking_.end();
}

/// Motion ends at once, and the position counts as lost.
void Controller::begin_alarm(bool answers) {
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
void Controller::unlock() {
  stop_motion();
  link_.forget_session();
}

/// 0x18 discards typed lines and the rest of a program.
void Controller::begin_reset() {
  leave_guarded_motion();
  reader_.clear();
  lines_at_cancel_ = 0;
  shots_.permit(false, idle_reason());
  outputs_off();
}

/// Called at rest.
void Controller::clear_for_reset() {
  refusal_ = Refusal::none;
  reader_.reset();
  outputs_off();
  reporter_.reset();
  end_overrides_of_program();
  end_program();
  start_up_next_ = 0;
  own_line_ = false;
}

/// What a terminal shows after power-up and a reset.
void Controller::greet() {
  send_banner();
  if (machine_.state() == State::alarm) say(unlock_text);
}

/// The machine is at rest, or its activity has nothing left to do.
bool Controller::is_settled() {
  const bool rests = motion_.at_rest() && !shots_.undecided();
  if (machine_.resets()) return rests && (!machine_.homes() || program_.idle());
  const bool ends = machine_.ends();
  switch (machine_.activity()) {
    case Activity::points:
      return ends ? rests : runner_.complete() && runner_.at_rest();
    case Activity::rows:
      return rows_.over() && !program_.cancelling();
    case Activity::program:
    case Activity::jog:
      break;
    case Activity::homing:
      return ends && program_.idle() && motion_.at_rest();
    case Activity::none:
      return ends;
  }
  if (beat_locked() && !rests) return false;
  if (!beat_locked() && !program_.idle()) return false;
  if (ends) return true;
  if (reader_.line_open()) return false;
  if (!beat_locked()) return program_.begun() && !runner_.begun();
  // The edge may have occurred since prepare(): with state idle every shot must be visible.
  runner_.read_outcomes();
  return runner_.drained();
}

// Called with beat and fill interrupts masked, as all of commit() is.
[[gnu::hot]] void Controller::settle() {
  if (!machine_.running() && !machine_.ends()) return;
  if (!is_settled()) return;
  handle(Event::settled, machine_.homes() ? homing_.alarm() : alarm_position_lost);
}

}  // namespace lamplock::machine
