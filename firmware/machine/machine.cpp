#include "firmware/machine/machine.hpp"

#include <array>

namespace lamplock::machine {
namespace {

using wire::HoldReason;

namespace state_table {

using enum State;
using enum Event;

constexpr ActivitySet of_none = activities(Activity::none);
constexpr ActivitySet of_points = activities(Activity::points);
constexpr ActivitySet of_rows = activities(Activity::rows);
constexpr ActivitySet of_job = of_points | of_rows;
constexpr ActivitySet of_program = activities(Activity::program);
constexpr ActivitySet of_tool = activities(Activity::tool_change);
constexpr ActivitySet of_lines = of_program | of_tool;
constexpr ActivitySet of_jog = activities(Activity::jog);
constexpr ActivitySet of_homing = activities(Activity::homing);
constexpr ActivitySet of_work = of_job | of_lines;
constexpr ActivitySet of_any = of_work | of_jog | of_homing | of_none;

constexpr StateSet waiting = states(holding, door);
constexpr StateSet active = states(running, holding, door);
constexpr StateSet ending = states(stopping, resetting, aborting);
constexpr StateSet any_state = active | ending | states(idle, check, sleep, alarm, estop);
constexpr StateSet may_fault = any_state & ~unsigned{states(estop)};
/// Nothing moves in a sleep, an alarm or an e-stop, where an axis may be pushed by hand.
constexpr StateSet sees_limits = any_state & ~unsigned{states(sleep, alarm, estop)};

/// Bytes of the user, and what the host or the switch of the door causes.
constexpr EventSet any_hold = events(hold_byte, hold);
constexpr EventSet any_door = events(door_byte, door_opened);

/// Whose events are refused or void while a condition holds.
struct When {
  Conditions needs = 0, excludes = 0;
};
constexpr When always{};
constexpr When door_shut_now{0, door_is_open};
constexpr When door_open_now{door_is_open, 0};
constexpr When host_lives{job_host_lives, 0};
constexpr When host_is_lost{0, job_host_lives};
constexpr When moves{is_moving, 0};
constexpr When after_lines{lines_have_begun, 0};
constexpr When tool_away{tool_is_away, 0};
constexpr When tool_awaited{tool_is_awaited, 0};
constexpr When tool_awaited_at_door{tool_is_awaited | door_is_open, 0};
constexpr When users_lines_are_done{0, users_line_runs | is_moving};

constexpr Transition row(EventSet on, StateSet from, ActivitySet of, When when, State next,
                         Activity next_activity, Effect effect,
                         ReasonRule reason = ReasonRule::clear) {
  return {on, from, of, when.needs, when.excludes, next, next_activity, effect, reason};
}
constexpr Transition row(Event event, StateSet from, ActivitySet of, When when, State next,
                         Activity next_activity, Effect effect,
                         ReasonRule reason = ReasonRule::clear) {
  return row(events(event), from, of, when, next, next_activity, effect, reason);
}
/// The activity does not change.
constexpr Transition row(EventSet on, StateSet from, ActivitySet of, When when, State next,
                         Effect effect, ReasonRule reason = ReasonRule::clear) {
  return row(on, from, of, when, next, same_activity, effect, reason);
}
constexpr Transition row(Event event, StateSet from, ActivitySet of, When when, State next,
                         Effect effect, ReasonRule reason = ReasonRule::clear) {
  return row(events(event), from, of, when, next, same_activity, effect, reason);
}
/// Neither state nor activity change.
constexpr Transition stay(EventSet on, StateSet from, ActivitySet of, When when, Effect effect,
                          ReasonRule reason = ReasonRule::keep) {
  return row(on, from, of, when, same_state, same_activity, effect, reason);
}
constexpr Transition stay(Event event, StateSet from, ActivitySet of, When when, Effect effect,
                          ReasonRule reason = ReasonRule::keep) {
  return row(events(event), from, of, when, same_state, same_activity, effect, reason);
}

constexpr auto table = std::to_array<Transition>({
    row(power_up_unhomed, states(idle), of_none, always, alarm, Effect::none),

    row(begin_points, states(idle), of_none, always, running, Activity::points, Effect::none),
    row(begin_rows, states(idle), of_none, always, running, Activity::rows, Effect::none),
    // With an open door a program waits, as if the door had been opened during it.
    row(begin_program, states(idle), of_none, door_open_now, door, Activity::program,
        Effect::hold_program_at_door),
    row(begin_program, states(idle), of_none, always, running, Activity::program, Effect::none),
    row(begin_program, waiting, of_none, always, same_state, Activity::program, Effect::none,
        ReasonRule::keep),
    row(begin_jog, states(idle), of_none, always, running, Activity::jog, Effect::none),
    stay(begin_jog, states(running), of_jog, always, Effect::none),
    row(begin_jog, states(running), of_tool, always, running, Activity::jog, Effect::none),
    row(begin_homing, states(idle), of_none, always, running, Activity::homing, Effect::none),
    row(begin_homing, states(alarm), of_none, always, running, Activity::homing, Effect::unlock),
    row(homed, states(running), of_homing, always, idle, Activity::none, Effect::none),

    row(hold_byte, states(idle), of_none, always, holding, Effect::hold_motion, ReasonRule::set),
    // After a job its host has no more to hold.
    row(hold, states(idle), of_none, after_lines, holding, Effect::hold_motion, ReasonRule::set),
    row(any_hold, states(running), of_work, always, holding, Effect::hold_motion, ReasonRule::set),
    stay(any_hold, states(holding), of_any, always, Effect::none, ReasonRule::outrank),
    stay(any_hold | events(cancel_jogs), states(door), of_any, tool_away, Effect::hold_parking),

    // A jog and homing do not continue after a hold.
    row(any_hold | any_door | events(stop, cancel_jogs), states(running), of_jog, always, stopping,
        Effect::cancel_jog),
    row(any_hold | events(stop, cancel_jogs), states(running), of_homing, always, stopping,
        Effect::abort_homing_with_alarm),
    row(any_door, states(running), of_homing, always, stopping, Effect::abort_homing_at_door),

    row(pause, states(idle) | active, of_program | of_none, door_open_now, door, Activity::program,
        Effect::none),
    row(pause, states(idle, running, holding), of_program | of_none, always, holding,
        Activity::program, Effect::none, ReasonRule::set),
    row(await_tool, states(idle, running), of_program | of_none, door_open_now, door,
        Activity::tool_change, Effect::none),
    row(await_tool, states(idle, running), of_program | of_none, always, running,
        Activity::tool_change, Effect::none),
    row(await_tool, waiting, of_program | of_none, always, same_state, Activity::tool_change,
        Effect::none, ReasonRule::keep),

    stay(resume, states(door), of_any, {tool_is_away, door_is_open}, Effect::return_tool),
    row(resume, waiting, of_none, door_shut_now, idle, Effect::resume_motion),
    row(resume, waiting, of_job | of_program, door_shut_now, running, Effect::resume_motion),
    row(resume, waiting, of_tool, door_shut_now, running, Effect::resume_lines),
    row(resume, states(running), of_tool, users_lines_are_done, running, Activity::program,
        Effect::end_tool_change),

    row(stop, active, of_job, always, stopping, Effect::stop_job),
    row(stop, active, of_lines, always, stopping, Effect::stop_program),
    row(stop, waiting, of_none, always, stopping, Activity::program, Effect::stop_program),
    stay(stop, states(check), of_none, always, Effect::refuse_program),

    stay(cancel_jogs, any_state, of_any, always, Effect::drop_jogs),

    // The host of a job of points stops it, or resumes it if the byte may have been noise
    // (--auto-resume). A job of rows ends, and so does a job without a host.
    row(reset, states(running), of_points, host_lives, holding, Effect::hold_motion,
        ReasonRule::set),
    stay(reset, states(holding), of_points, host_lives, Effect::none, ReasonRule::set),
    row(reset, active, of_job, always, stopping, Effect::end_job, ReasonRule::set),
    row(reset, states(stopping), of_job, always, resetting, Effect::begin_reset, ReasonRule::keep),
    row(reset, states(running, stopping), of_homing, always, aborting, Effect::abort_homing),
    row(reset, states(running, stopping), of_jog, moves, aborting, Effect::abort_jog),
    row(reset, active | states(stopping), of_lines | of_none, moves, aborting,
        Effect::abort_program),
    row(reset, active | states(stopping, idle, check), of_any, always, resetting,
        Effect::begin_reset),
    row(reset, states(sleep), of_none, always, aborting, Effect::begin_reset),
    stay(reset, states(alarm, estop), of_none, always, Effect::reset_at_rest),
    stay(reset, states(resetting, aborting), of_any, always, Effect::begin_reset),

    row(door_byte, states(idle), of_none, always, door, Effect::hold_at_door),
    row(door_byte, states(running), of_job, always, holding, Effect::hold_motion, ReasonRule::set),
    stay(door_byte, states(holding), of_job, always, Effect::none, ReasonRule::outrank),
    row(door_opened, states(running, holding), of_job, always, door, Effect::hold_at_door),
    row(any_door, states(running, holding), of_lines | of_none, always, door, Effect::hold_at_door),
    stay(any_door, states(door), of_any, always, Effect::keep_parked),

    // Then a job waits for a resume by its user; a program stays at the door.
    row(door_shut, states(door), of_job, always, holding, Effect::none, ReasonRule::set),

    // A reset that waits for the machine is made at once.
    row(limit, states(resetting, aborting), of_work | of_jog | of_none, always, alarm,
        Activity::none, Effect::finish_abort),
    row(fault, states(resetting, aborting), of_any, always, alarm, Activity::none,
        Effect::finish_abort),
    row(estop_pressed, states(resetting, aborting), of_any, always, estop, Activity::none,
        Effect::finish_abort),
    // Homing makes switches engage.
    row(limit, sees_limits, of_work | of_jog | of_none, always, alarm, Activity::none,
        Effect::raise_alarm),
    row(fault, may_fault, of_any, always, alarm, Activity::none, Effect::raise_alarm),
    // No other alarm may suggest that `$X` could clear an e-stop.
    stay(fault, states(estop), of_none, always, Effect::raise_alarm),
    row(estop_pressed, any_state, of_any, always, estop, Activity::none, Effect::raise_alarm),
    row(estop_released, states(estop), of_none, always, alarm, Effect::release_estop),

    row(unlock, states(alarm), of_none, door_shut_now, idle, Effect::unlock),
    row(unlock, waiting, of_job, host_is_lost, stopping, Effect::stop_job),

    row(go_to_sleep, states(idle, check, alarm), of_none, always, sleep, Effect::switch_off),
    row(toggle_check, states(idle), of_none, always, check, Effect::begin_check),
    row(toggle_check, states(check), of_none, always, idle, Effect::end_check),

    row(settled, states(running), of_points | of_program, always, idle, Activity::none,
        Effect::none),
    row(settled, states(running), of_rows, always, idle, Activity::none, Effect::finish_rows),
    row(settled, states(running, stopping), of_jog, tool_awaited_at_door, door,
        Activity::tool_change, Effect::finish_jog_at_door),
    row(settled, states(running, stopping), of_jog, tool_awaited, running, Activity::tool_change,
        Effect::finish_jog),
    row(settled, states(running, stopping), of_jog, always, idle, Activity::none,
        Effect::finish_jog),
    row(settled, states(stopping), of_points, always, idle, Activity::none, Effect::finish_job,
        ReasonRule::keep),
    row(settled, states(stopping), of_rows, always, idle, Activity::none, Effect::finish_rows,
        ReasonRule::keep),
    row(settled, states(stopping), of_lines, always, idle, Activity::none, Effect::finish_program),
    row(settled, states(stopping), of_homing, always, alarm, Activity::none, Effect::raise_alarm),
    row(settled, states(resetting), of_any, always, idle, Activity::none, Effect::finish_reset),
    row(settled, states(aborting), of_any, always, alarm, Activity::none, Effect::finish_abort),
});

}  // namespace state_table

/// Whether a hold for another reason replaces the present one. The host only resumes what its own
/// silence has held, and a hold by the host is not ended by a byte.
bool outranks(HoldReason asked, HoldReason present) {
  return asked == HoldReason::host ||
         (asked == HoldReason::realtime && present == HoldReason::dead_man);
}

}  // namespace

std::span<const Transition> transitions() { return state_table::table; }

const Transition* find_transition(Event event, State state, Activity activity,
                                  Conditions conditions) {
  for (const Transition& t : state_table::table)
    if ((t.on & events(event)) != 0 && (t.from & states(state)) != 0 &&
        (t.of & activities(activity)) != 0 && (conditions & t.needs) == t.needs &&
        (conditions & t.excludes) == 0)
      return &t;
  return nullptr;
}

Effect Machine::apply(Event event, Conditions conditions, std::uint8_t detail) {
  const Transition* t = find_transition(event, state_, activity_, conditions);
  if (t == nullptr) return Effect::none;
  if (t->next != same_state) state_ = t->next;
  if (t->next_activity != same_activity) activity_ = t->next_activity;
  const auto reason = static_cast<HoldReason>(detail);
  switch (t->reason) {
    case ReasonRule::clear:
      hold_reason_ = HoldReason::none;
      break;
    case ReasonRule::set:
      hold_reason_ = reason;
      break;
    case ReasonRule::outrank:
      if (outranks(reason, hold_reason_)) hold_reason_ = reason;
      break;
    case ReasonRule::keep:
      break;
  }
  const bool new_alarm =
      t->next == State::estop || (t->next == State::alarm && event != Event::estop_released);
  if (new_alarm || !locked()) alarm_ = new_alarm ? detail : 0;
  return t->effect;
}

}  // namespace lamplock::machine
