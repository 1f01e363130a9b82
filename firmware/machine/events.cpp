// Events of the machine, their effects by name, and the end of an activity.
#include "firmware/machine/events.hpp"

namespace lamplock::machine {

Conditions MachineEvents::conditions() const {
  unsigned now = 0;
  if (door_open()) now |= door_is_open;
  if (host_lives()) now |= job_host_lives;
  // Light at rest is a motion without steps.
  if (!motion_.at_rest() && !program_.shines_at_rest()) now |= is_moving;
  if (parking_.stage() != Parking::Stage::off) now |= tool_is_away;
  if (program_.begun()) now |= lines_have_begun;
  if (reader_.awaits_tool()) now |= tool_is_awaited;
  if (reader_.users_line_runs()) now |= users_line_runs;
  return static_cast<Conditions>(now);
}

// Called with beat and fill interrupts masked, as all that it causes.
void MachineEvents::handle(Event event, std::uint8_t detail) {
  perform(machine_.apply(event, conditions(), detail));
}

void MachineEvents::perform(Effect effect) {
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
      report_message("Check Door");
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
      reader_.resume();
      break;
    case Effect::resume_lines:
      program_.resume();
      break;
    case Effect::end_tool_change:
      reader_.end_tool_change();
      break;
    case Effect::drop_jogs:
      lines_at_cancel_ = reader_.lines();
      break;
    case Effect::begin_check:
      report_message("Enabled");
      break;
    case Effect::end_check:
      report_message("Disabled");
      reader_.reset();
      greet();
      break;
    case Effect::switch_off:
      report_message("Sleeping");
      outputs_off();
      break;
    default:
      perform_end(effect);
      break;
  }
}

/// Effects that end an activity, or begin to.
void MachineEvents::perform_end(Effect effect) {
  switch (effect) {
    case Effect::cancel_jog:
      return cancel_jog();
    case Effect::stop_job:
      return stop_motion();
    case Effect::end_job:
      stop_motion();
      return report_message("Job ended by a reset");
    case Effect::stop_program:
      return stop_program();
    case Effect::refuse_program:
      return refuse_program();
    case Effect::abort_homing_with_alarm:
      return abort_homing_with_alarm(alarm_homing_reset);
    case Effect::abort_homing_at_door:
      return abort_homing_with_alarm(alarm_homing_door);
    case Effect::unlock:
      return unlock();
    case Effect::raise_alarm:
      return begin_alarm(true);
    case Effect::release_estop:
      return report_message(unlock_text);
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
      return abort_homing_with_alarm(alarm_homing_reset);
    case Effect::finish_job:
      // The edge may have occurred since prepare(): with state idle every shot must be visible.
      return runner_.read_outcomes();
    case Effect::finish_rows:
      end_program();
      return end_overrides_of_program();
    case Effect::finish_program:
      return finish_program();
    case Effect::finish_jog_at_door:
      program_.hold();
      [[fallthrough]];
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

/// The machine is at rest, or its activity has nothing left to do.
bool MachineEvents::is_settled() {
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
    case Activity::tool_change:
      if (!ends) return false;
      break;
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
[[gnu::hot]] void MachineEvents::settle() {
  if (!machine_.running() && !machine_.ends()) return;
  if (!is_settled()) return;
  handle(Event::settled, machine_.homes() ? homing_.alarm() : alarm_position_lost);
}

}  // namespace lamplock::machine
