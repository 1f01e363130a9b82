// The states of the machine: one table says which event leads from which state to which.
//
// In:  events, each with the conditions at that moment, and a reason or a number of an alarm.
// Out: the state, and the effect that the controller has to cause.
// Who: the controller, main loop, beat and fill interrupts masked where the effect changes what
//      they use; reading the state is free. An event takes some 5 us, and no state changes without
//      one.
//
// What the machine does (Activity) and how far it is (State) are two things: a hold, a door or a
// stop is the same for all activities but for its effect. What grbl or the wire reports is derived
// (wire_state). Inputs, the hosts and the refusal of lines after an error are conditions beside the
// state, not part of it.
//
//             begin            hold, pause              door
//   idle ------------> running ------------> holding ---------> door
//    ^                  |  |  <------------ resume <-------------'
//    |  settled         |  | stop           | stop               | stop
//    +------------------+  v                v                    v
//    +---------------- stopping, resetting (0x18): at rest ------'
//
// M6 makes a tool change of a program: it runs, at rest, and after an acknowledgement (0xA3) lines
// and jogs of the user move the machine; a hold or a door during it leads back to it. A resume from
// there continues the program.
//
// All of them end in `alarm` by a fault, in `estop` while the e-stop is pressed.
#pragma once

#include <cstdint>
#include <span>

#include "shared/wire/status.hpp"

namespace lamplock::machine {

enum class State : std::uint8_t {
  idle,
  check,      ///< `$C`: programs are read and not run
  sleep,      ///< `$SLP`: drives off until a reset
  alarm,      ///< until `$X` or `$H`
  estop,      ///< the e-stop is pressed
  running,    ///< an activity runs, or waits for its next line or point
  holding,    ///< comes to rest and stays there until a resume
  door,       ///< the same; the door has been opened
  stopping,   ///< comes to rest and ends its activity
  resetting,  ///< a reset is due when the machine rests
  aborting    ///< the same; motion was interrupted, so that the position counts as lost
};
inline constexpr int state_count = 11;
/// In the table: the event does not change the state.
inline constexpr auto same_state = static_cast<State>(state_count);

/// What the machine does; none while it is at rest without a task.
enum class Activity : std::uint8_t {
  none,
  points,   ///< a job of points, in frames
  rows,     ///< a job of rows of pixels, in frames
  program,  ///< lines of G-code, also with points on the beat
  jog,
  homing,
  tool_change  ///< a program waits for the tool of its M6; lines of the user run meanwhile
};
inline constexpr int activity_count = 7;
/// In the table: the event does not change the activity.
inline constexpr auto same_activity = static_cast<Activity>(activity_count);

enum class Event : std::uint8_t {
  power_up_unhomed,
  begin_points,
  begin_rows,
  begin_program,  ///< a line that takes time
  begin_jog,
  begin_homing,
  homed,
  hold_byte,   ///< `!`, also at rest
  hold,        ///< by the host, or because of a silent host, the lamp, or a shot that was not made
  pause,       ///< M0, M1, a late M66
  await_tool,  ///< M6
  resume,
  stop,         ///< COMMAND stop, or a job that cannot continue
  cancel_jogs,  ///< 0x85
  reset,        ///< 0x18
  door_byte,    ///< 0x84
  door_opened,
  door_shut,
  limit,  ///< a limit switch
  fault,  ///< any other alarm
  estop_pressed,
  estop_released,
  unlock,        ///< `$X`
  go_to_sleep,   ///< `$SLP`
  toggle_check,  ///< `$C`,
  settled        ///< Controller::is_settled()
};
inline constexpr int event_count = 26;

/// What the controller does for an event.
enum class Effect : std::uint8_t {
  none,
  hold_motion,
  hold_at_door,
  hold_program_at_door,  ///< that has just begun
  keep_parked,           ///< the door has opened again
  hold_parking,
  return_tool,
  resume_motion,
  resume_lines,     ///< of the user, in a tool change
  end_tool_change,  ///< the program continues
  cancel_jog,
  drop_jogs,  ///< those that wait
  stop_job,
  end_job,  ///< by a reset, with a message
  stop_program,
  refuse_program,  ///< lines of a program that is checked
  abort_homing_with_alarm,
  abort_homing_at_door,
  unlock,
  raise_alarm,
  release_estop,
  switch_off,
  begin_check,
  end_check,
  reset_at_rest,  ///< at once: nothing moves
  begin_reset,    ///< at rest, or a stop is in progress
  abort_program,  ///< by a reset
  abort_jog,      ///< by a reset
  abort_homing,   ///< by a reset
  finish_job,     ///< of points
  finish_rows,
  finish_program,  ///< that was stopped
  finish_jog,
  finish_jog_at_door,  ///< in a tool change
  finish_reset,
  finish_abort
};

/// Conditions beside the state, a bit for each.
using Conditions = std::uint8_t;
inline constexpr Conditions door_is_open = 1, job_host_lives = 2, is_moving = 4, tool_is_away = 8,
                            lines_have_begun = 16,  ///< and no job since
    tool_is_awaited = 32,                           ///< by a program
    users_line_runs = 64;                           ///< or waits, in a tool change
inline constexpr int condition_count = 7;

/// Sets, a bit for each.
using EventSet = std::uint32_t;
using StateSet = std::uint16_t;
using ActivitySet = std::uint8_t;
template <class... E>
constexpr EventSet events(E... e) {
  return ((EventSet{1} << static_cast<unsigned>(e)) | ...);
}
template <class... S>
constexpr StateSet states(S... s) {
  return static_cast<StateSet>(((1u << static_cast<unsigned>(s)) | ...));
}
template <class... A>
constexpr ActivitySet activities(A... a) {
  return static_cast<ActivitySet>(((1u << static_cast<unsigned>(a)) | ...));
}

/// Effect of an event on the reason of a hold.
enum class ReasonRule : std::uint8_t {
  clear,
  set,      ///< as the event says
  outrank,  ///< as the event says, if that counts more: the host above all, `!` above its silence
  keep
};

/// A row of the table: in one of these states and activities, with all of `needs` and none of
/// `excludes`, each of these events leads to `next`. The first row that fits counts; without one
/// the event changes nothing.
struct Transition {
  EventSet on;
  StateSet from;
  ActivitySet of;
  Conditions needs, excludes;
  State next;
  Activity next_activity;
  Effect effect;
  ReasonRule reason;
};

/// All of them, in the order of their search.
[[gnu::cold]] std::span<const Transition> transitions();
/// The row for an event; null if it changes nothing.
[[gnu::cold]] const Transition* find_transition(Event event, State state, Activity activity,
                                                Conditions conditions);

/// The state as the wire reports it.
constexpr wire::MachineState wire_state(State state, Activity activity) {
  switch (state) {
    case State::idle:
    case State::check:
    case State::sleep:
      return wire::MachineState::idle;
    case State::alarm:
      return wire::MachineState::alarm;
    case State::estop:
      return wire::MachineState::estop;
    case State::holding:
      return wire::MachineState::hold;
    case State::door:
      return wire::MachineState::door;
    case State::running:
      if (activity == Activity::tool_change) return wire::MachineState::hold;
      break;
    case State::stopping:
    case State::resetting:
    case State::aborting:
      break;
  }
  return activity == Activity::homing ? wire::MachineState::home : wire::MachineState::run;
}

class Machine {
 public:
  /// The only function that changes the state. `detail`: a wire::HoldReason, or a number of an
  /// alarm. Returns what is due now.
  [[gnu::cold]] Effect apply(Event event, Conditions conditions, std::uint8_t detail = 0);
  /// Whether the event has a row now.
  [[gnu::cold]] bool accepts(Event event, Conditions conditions = 0) const {
    return find_transition(event, state_, activity_, conditions) != nullptr;
  }

  State state() const { return state_; }
  Activity activity() const { return activity_; }
  wire::HoldReason hold_reason() const { return hold_reason_; }
  /// Number of the alarm; 0 = none.
  std::uint8_t alarm() const { return alarm_; }

  bool in(StateSet set) const { return (set >> static_cast<unsigned>(state_) & 1u) != 0; }
  bool does(ActivitySet set) const { return (set >> static_cast<unsigned>(activity_) & 1u) != 0; }
  bool idle() const { return state_ == State::idle; }
  bool running() const { return state_ == State::running; }
  bool locked() const { return in(states(State::alarm, State::estop)); }
  bool checks() const { return state_ == State::check; }
  bool sleeps() const { return state_ == State::sleep; }
  /// Held without an activity, by `!` or 0x84 at rest.
  bool held_at_rest() const {
    return activity_ == Activity::none && in(states(State::holding, State::door));
  }
  bool jogs() const { return activity_ == Activity::jog; }
  bool homes() const { return activity_ == Activity::homing; }
  /// A program waits for its tool; also in a hold or at a door, but not during a jog.
  bool changes_tool() const { return activity_ == Activity::tool_change; }
  /// A job that came in frames.
  bool framed() const { return does(activities(Activity::points, Activity::rows)); }
  /// The activity ends when the machine is at rest.
  bool ends() const { return in(states(State::stopping, State::resetting, State::aborting)); }
  bool resets() const { return in(states(State::resetting, State::aborting)); }

 private:
  State state_ = State::idle;
  Activity activity_ = Activity::none;
  wire::HoldReason hold_reason_ = wire::HoldReason::none;
  std::uint8_t alarm_ = 0;
};

}  // namespace lamplock::machine
