// The interpreter of G-code: lines become actions.
//
// In:  lines, one at a time (firmware/link puts them together and takes real-time bytes out).
// Out: for each line either an error with its column, and nothing has changed, or the actions that
//      the line asks for: run() checks the line and puts it into force, next() then gives its
//      actions one at a time. Nothing is queued: pieces of curves and moves of cycles are made when
//      they are asked for.
// Who: the machine, at main-loop level, one line when the actions of the line before are taken.
// Budget: at 5000 lines/s a core of 125 MHz has 25 000 cycles a line; a plain move takes about a
//      fifth of that. Divisions of 64 bits are made only where decimals are lost or a mode asks
//      for them (G93, G95, M30).
//
// Language: RS274/NGC as grbl 1.1 has it; splines, rotation, canned cycles, saved state and so on
// as LinuxCNC has them ("G-code Reference", "M-code Reference"); M130, M131 are ours. All axes are
// lengths: A follows G20 like X Y Z. What is decided here and not there:
//   * G68 turns round a centre that stays where it is on the machine, by R degrees counted from no
//     rotation, in the plane that was in force; without X and Y round the place where the machine
//     stands. G53, G28 and G30 know nothing of it. The end of a program ends it.
//   * M70 to M73 take place before everything else in their line; there is one saved state. It does
//     not hold the motion mode and the tool. There being no subroutines, M73 restores at the end
//     of the program: not spindle, coolant and beat lock, which stay off.
//   * M126 to M128 hold until the end of the program or a reset; then the settings do.
//   * M1 pauses like M0. M2 and M30 are the same.
//   * G92 and G43.1 are out of force after a reset; G92.3 brings the stored shift back.
//   * S with a list of powers divides a G1 into as many pieces (power_list.hpp); the last one
//   stays.
//   * Cycles: R, Z, Q and P stay until another cycle begins; A moves together with X and Y.
//
// Position: the interpreter knows where the program is, which the machine reaches later. After
// homing, a probe, a jog that was broken off and the like the machine tells by set_position().
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "firmware/program/action.hpp"
#include "firmware/program/curve.hpp"
#include "firmware/program/cycles.hpp"
#include "firmware/program/modal.hpp"
#include "firmware/program/parameters.hpp"
#include "firmware/program/power_list.hpp"
#include "firmware/program/statement.hpp"
#include "firmware/program/time_share.hpp"
#include "firmware/program/words.hpp"

namespace lamplock::program {

class Interpreter {
 public:
  /// Both must outlive the interpreter. Options may change while it is not busy.
  [[gnu::cold]] Interpreter(Parameters& parameters, const Options& options)
      : parameters_(parameters), options_(options) {}
  Interpreter(const Interpreter&) = delete;
  Interpreter& operator=(const Interpreter&) = delete;

  /// Checks a line and puts it into force; only while not busy(). With an error nothing at all has
  /// changed. The column counts from 1.
  Fault run(std::string_view line);
  /// The same with what stands behind "$J=", which the column counts from: a move with a feed of
  /// its own, in G94, spindle and beat lock off; the modal state stays as it is.
  Fault jog(std::string_view line);
  /// The next action of the line; false when there is none left. M2 and M30 set the modal state
  /// back when their action is given.
  bool next(Action& action);
  /// Whether next() has something left.
  bool busy() const { return plan_.stages != 0; }

  /// The user switches flood or mist by hand; the program goes on from there.
  void toggle_flood() { state_->modal.flood = !state_->modal.flood; }
  void toggle_mist() { state_->modal.mist = !state_->modal.mist; }

  /// Spindle and coolant are off, whoever has seen to that.
  void switch_off() {
    state_->modal.flood = state_->modal.mist = false;
    state_->modal.spindle = Spindle::off;
  }

  /// After power-up and soft reset: modal state as it is by default, nothing left to do. Position
  /// and parameters stay.
  void reset();
  /// The machine is here and nothing is left to do.
  void set_position(const Place& machine_e7);
  /// The machine is here; what is left of the line goes on from there.
  void stand_at(const Place& machine_e7);

  const Modal& modal() const { return state_->modal; }
  /// What is in force of the pulses, by the program or the settings; 0 a millimetre: none.
  std::uint32_t pulses_milli() const;
  std::uint32_t pulse_ns() const;
  const State& state() const { return *state_; }
  const Saved& saved() const { return saved_; }
  /// The end of the program so far, in machine coordinates.
  const Place& machine_e7() const { return state_->machine_e7; }
  /// The same without rotation.
  const Place& programmed_e7() const { return state_->programmed_e7; }
  /// What a program's coordinates are off machine coordinates (grbl's WCO); a rotation comes on
  /// top.
  Place work_offset_e7() const;

 private:
  void take_over(const Statement& statement);
  void begin_curve(const Statement& statement);
  void begin_pieces(std::string_view powers);
  void change_parameters(const Changes& changes);
  void begin_action(Action& action, ActionKind kind) const;
  bool give(Stage stage, Action& action);
  [[gnu::cold]] bool give_io(Stage stage, Action& action);
  bool give_dwell(Action& action);
  bool give_move(Stage stage, Action& action);
  bool give_piece(Action& action);
  bool one_row() const { return options_.rows && !pulses(); }
  /// Quick where there are none.
  bool pulses() const {
    const Pulses::Switch on = state_->modal.pulses.on;
    if (on == Pulses::Switch::as_set ? options_.pulses_milli == 0 : on == Pulses::Switch::off)
      return false;
    return pulses_milli() != 0;
  }
  bool give_curve(Action& action);
  bool give_cycle(Action& action);
  bool give_stop(Action& action);
  void fill_move(Action& action, bool rapid) const;
  void done(Stage stage) { plan_.stages &= ~(1u << static_cast<int>(stage)); }
  void end_program();
  void restore_saved();

  std::array<State, 2> states_;
  State* state_ = &states_[0];
  State* next_ = &states_[1];  ///< room for the one behind the next line
  Saved saved_;
  Plan plan_{};
  Curve curve_;
  TimeShare share_;
  DrillCycle cycle_;
  std::array<char, PowerList::most_characters> power_text_;  ///< of the pieces of a line
  PowerList powers_;
  std::uint32_t pieces_ = 0;  ///< given
  Parameters& parameters_;
  const Options& options_;
};

}  // namespace lamplock::program
