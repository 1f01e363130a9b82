// Events of the machine and what they cause: stops, holds, alarms, resets.
//
// In:  events from the host, inputs, the lamp and the activities (machine.hpp); the conditions of
//      the parts.
// Out: orders to the runners, the shots, the outputs, parking and homing; messages.
// Who: the later layers, main loop, with beat and fill interrupts masked; 0.2 ms at most.
//
// handle() looks up the row of the table and causes its effect. settle() is called in each round
// and ends an activity that is over.
#pragma once

#include "firmware/machine/parts.hpp"

namespace lamplock::machine {

class MachineEvents : public MachineParts {
 protected:
  // Alarm numbers of grbl 1.1; 10 as in grblHAL.
  static constexpr std::uint8_t alarm_hard_limit = 1;
  static constexpr std::uint8_t alarm_soft_limit = 2;
  static constexpr std::uint8_t alarm_position_lost = 3;  ///< "reset while in motion"
  static constexpr std::uint8_t alarm_probe_state = 4;    ///< already in its final state
  static constexpr std::uint8_t alarm_probe_nothing = 5;
  static constexpr std::uint8_t alarm_homing_reset = 6;
  static constexpr std::uint8_t alarm_homing_door = 7;
  static constexpr std::uint8_t alarm_homing_engaged = 8;    ///< after pulling off
  static constexpr std::uint8_t alarm_homing_not_found = 9;  ///< a switch
  static constexpr std::uint8_t alarm_estop = 10;
  static constexpr std::uint8_t alarm_homing_wanted = 11;
  static constexpr std::uint8_t alarm_homing_not_squared = 15;  ///< as in grblHAL

  static constexpr std::uint8_t min_override = 10, max_override = 200;  ///< percent

  using MachineParts::MachineParts;

  [[gnu::cold]] void handle(Event event, std::uint8_t detail = 0);
  void handle(Event event, wire::HoldReason reason) {
    handle(event, static_cast<std::uint8_t>(reason));
  }
  void raise_alarm(std::uint8_t number) { handle(Event::fault, number); }
  /// Ends the present activity if it is over.
  void settle();

  // Effects that other layers use too (effects.cpp).
  /// Points stop at once, lines when their planner does.
  void brake_points();
  /// No line is left, or none continues.
  void end_program();
  /// No further line of a program begins; accepted lines run to their end.
  [[gnu::cold]] void refuse_lines(Refusal until, std::string_view reason);
  void end_refusal() {
    if (refusal_ == Refusal::until_unlocked) refusal_ = Refusal::none;
  }
  [[gnu::cold]] void outputs_off();
  void use_overrides();
  void end_overrides_of_program();
  [[gnu::cold]] void clear_racking();

 private:
  Conditions conditions() const;
  bool is_settled();
  std::uint32_t loop_feed_percent(std::uint32_t percent) const;
  [[gnu::cold]] void perform(Effect effect);
  [[gnu::cold]] void perform_end(Effect effect);
  [[gnu::cold]] void hold_motion();
  [[gnu::cold]] void hold_at_door();
  void begin_parking();
  [[gnu::cold]] void stop_motion();
  [[gnu::cold]] void stop_lines();
  [[gnu::cold]] void refuse_program();
  [[gnu::cold]] void stop_program();
  [[gnu::cold]] void finish_program();
  [[gnu::cold]] void leave_guarded_motion();
  [[gnu::cold]] void begin_alarm(bool answers);
  [[gnu::cold]] void unlock();
  [[gnu::cold]] void begin_reset();
  [[gnu::cold]] void clear_for_reset();
  void cancel_jog();
  void abort_homing_with_alarm(std::uint8_t alarm);
  void drop_homing(bool answers);
  [[gnu::cold]] void drop_open_line();
};

}  // namespace lamplock::machine
