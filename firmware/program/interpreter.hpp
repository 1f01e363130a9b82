// The interpreter of G-code: converts lines to actions.
//
// In:  lines, one at a time (firmware/link assembles them and removes real-time bytes).
// Out: for each line either an error with its column and no change, or the actions of the line:
//      run() checks the line and makes it effective, next() then returns its actions one at a time.
//      There is no queue: pieces of curves and moves of cycles are made on demand.
// Who: the machine, at main-loop level, one line when the actions of the previous one have been
//      taken. Budget: at 5000 lines/s a core of 125 MHz has 25 000 cycles a line; a plain move
//      takes about a fifth of that. Divisions of 64 bits are made only where decimals are lost or a
//      mode requires them (G93, G95, M30).
//
// Language: RS274/NGC as in grbl 1.1; splines, rotation, canned cycles, saved state and so on as in
// LinuxCNC ("G-code Reference", "M-code Reference"); M130, M131 are extensions. All axes are
// lengths: A follows G20 like X Y Z. Decisions that differ or are open there:
//   * G68 rotates round a centre that is constant on the machine, by R degrees counted from no
//     rotation, in the active plane; without X and Y round the present position. G53, G28 and G30
//     ignore it. The end of a program ends it. The rotation of a coordinate system (G10 L2 R) acts
//     before it: G68 turns what the rotated system results in.
//   * M70 to M73 act before all other words of their line; there is one saved state. It does not
//     include the motion mode and the tool. As there are no subroutines, M73 restores at the end of
//     the program: except spindle, coolant and beat lock, which stay off.
//   * M126 to M128 hold until the end of the program or a reset; then the settings apply.
//   * M1 pauses like M0. M2 and M30 are the same.
//   * G92 is inactive after a reset; G92.3 activates the stored shift again. A tool length stays.
//   * S with a list of powers divides a G1 into as many pieces (power_list.hpp); the last stays.
//   * Parameters (#1, #<name>) are unset at the end of a program and by a reset, so that a program
//     does the same each time; those above #5000 can only be read.
//   * Cutter compensation (compensation.hpp) is off after a reset and whenever the machine sets the
//   position. After G40 moves along the other axes stay
//     beside the contour.
//   * Cycles: R, Z, Q and P stay until another cycle begins; in G91 R counts from where the series
//     began. A moves together with X and Y.
//
// Position: the interpreter has the position of the program, which the machine reaches later. After
// homing, a probe, an interrupted jog and the like the machine calls set_position().
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

#include "firmware/program/action.hpp"
#include "firmware/program/compensation.hpp"
#include "firmware/program/curves/curve.hpp"
#include "firmware/program/curves/curve_timing.hpp"
#include "firmware/program/cycles.hpp"
#include "firmware/program/expression.hpp"
#include "firmware/program/extent.hpp"
#include "firmware/program/message.hpp"
#include "firmware/program/modal.hpp"
#include "firmware/program/parameters.hpp"
#include "firmware/program/power_list.hpp"
#include "firmware/program/statement.hpp"
#include "shared/gcode_words.hpp"

namespace lamplock::program {

class Interpreter {
 public:
  /// Both must outlive the interpreter. Options may change while it is not busy.
  [[gnu::cold]] Interpreter(Parameters& parameters, const Options& options)
      : parameters_(parameters), options_(options) {}
  Interpreter(const Interpreter&) = delete;
  Interpreter& operator=(const Interpreter&) = delete;

  /// Checks a line and makes it effective; only while not busy(). After an error nothing has
  /// changed. The column counts from 1.
  Fault run(std::string_view line);
  /// The same for the text after "$J=", from which the column counts: a move with its own feed
  /// rate, in G94, spindle and beat lock off; the modal state does not change.
  Fault jog(std::string_view line);
  /// The next action of the line; false if there are no more. The action of M2 and M30 also resets
  /// the modal state.
  bool next(Action& action);
  /// After run(): the line is a curve, a cycle, or moves to an intermediate place first; what it
  /// reaches is extent().
  bool has_extent() const {
    constexpr std::uint32_t stages =
        1u << static_cast<int>(Stage::curve) | 1u << static_cast<int>(Stage::cycle) |
        1u << static_cast<int>(Stage::via) | 1u << static_cast<int>(Stage::held);
    return (plan_.stages & stages) != 0;
  }
  /// What the line reaches, if has_extent() and no action has been taken.
  [[gnu::cold]] Extent extent() const;
  /// Words without effect that the program has used for the first time since the last call, a bit
  /// for each (Ignored); and message_bit if a line may have had a message.
  std::uint8_t take_ignored() { return std::exchange(new_ignored_, std::uint8_t{0}); }
  bool has_ignored() const { return new_ignored_ != 0; }
  /// As program::take_message(), with the parameters of this program.
  [[gnu::cold]] bool take_message(std::string_view& line, TextLine& text) {
    return program::take_message(line, expressions_, text);
  }
  /// next() has more actions.
  bool busy() const { return plan_.stages != 0; }
  /// Cutter compensation holds a move until the next one, G40 or the end of the program.
  bool holds_move() const {
    return state_->modal.cutter != Cutter::off && work_.compensation.holds();
  }

  /// The user switches flood or mist manually; the program continues with that.
  void toggle_flood() { state_->modal.flood = !state_->modal.flood; }
  void toggle_mist() { state_->modal.mist = !state_->modal.mist; }

  /// Parameters are unset as at the end of a program, and modes that M70 and M73 have saved are
  /// dropped; nothing else changes.
  [[gnu::cold]] void clear_parameters() {
    expressions_.clear();
    saved_ = {};
  }

  /// Spindle and coolant were switched off.
  void switch_off() {
    state_->modal.flood = state_->modal.mist = false;
    state_->modal.spindle = Spindle::off;
  }

  /// After power-up and soft reset: default modal state, no actions left. Position and parameters
  /// are kept.
  void reset();
  /// Sets the position of the machine; no actions may be left.
  void set_position(const Place& machine_e7);
  /// Sets the position of the machine; the rest of the line continues from there.
  void stand_at(const Place& machine_e7);
  /// In a tool change: lines of the user follow, which must not have commands that stop or end a
  /// program; no actions may be left.
  [[gnu::cold]] void begin_users_lines();
  /// The program continues with this modal state, at this place of the machine, and with the shift
  /// and tool length of the user. The way there is the line's next actions: as rapids, at the
  /// higher Z of both places.
  [[gnu::cold]] void end_users_lines(const Modal& modal, const Place& machine_e7);
  /// The program does not continue.
  [[gnu::cold]] void drop_users_lines() { users_lines_ = false; }

  const Modal& modal() const { return state_->modal; }
  /// Active pulses, from the program or the settings; 0 per millimetre: none.
  std::uint32_t pulses_milli() const;
  std::uint32_t pulse_ns() const;
  const State& state() const { return *state_; }
  /// Parameters that the program has set.
  const Variables& variables() const { return expressions_.variables(); }
  /// Results of probes and inputs, which the program reads as parameters.
  Results& results() { return expressions_.results(); }
  const Saved& saved() const { return saved_; }
  /// Present end of the program, in machine coordinates.
  const Place& machine_e7() const { return state_->machine_e7; }
  /// The same without rotation.
  const Place& programmed_e7() const { return state_->programmed_e7; }
  /// Work coordinates minus machine coordinates (grbl's WCO), before rotation.
  Place work_offset_e7() const;

 private:
  void take_over(const Statement& statement);
  void begin_curve();
  CurvePlane curve_plane() const;
  ArcRequest arc_request() const;
  SplineRequest spline_request() const;
  [[gnu::cold]] NurbsRequest nurbs_request() const;
  [[gnu::cold]] void add_nurbs_points();
  [[gnu::cold]] void save(std::uint16_t code);
  [[gnu::cold]] void ignore(std::uint8_t words);
  void begin_pieces(std::string_view powers);
  [[gnu::cold]] void change_parameters(const Changes& changes);
  void begin_action(Action& action, ActionKind kind) const;
  bool give(Stage stage, Action& action);
  [[gnu::cold]] bool give_io(Stage stage, Action& action);
  bool give_dwell(Action& action);
  bool give_move(Stage stage, Action& action);
  bool give_piece(Action& action);
  bool one_row() const { return options_.rows && !pulses(); }
  /// Fast if there are none.
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
  [[gnu::cold]] void find_programmed();
  void restore_saved();

  // Cutter compensation (interpreter_compensation.cpp).
  [[gnu::cold]] Fault run_compensated(Statement& statement, std::string_view line, Fault fault);
  [[gnu::cold]] Fault check_compensated(Statement& statement, std::string_view line);
  [[gnu::cold]] Fault run_users(Statement& statement, Fault fault);
  [[gnu::cold]] bool stays_beside(const Statement& statement) const;
  [[gnu::cold]] Fault compensate(const Statement& statement);
  [[gnu::cold]] GcodeError compensate_line(const Statement& statement);
  [[gnu::cold]] GcodeError compensate_move();
  [[gnu::cold]] GcodeError end_compensation(const Statement& statement);
  [[gnu::cold]] PlaneBlock plane_block(const State& from, const State& to) const;
  bool moves_in_plane() const;
  void collect_between();
  [[gnu::cold]] bool give_held(Action& action);
  [[gnu::cold]] bool give_corner(Action& action);
  [[gnu::cold]] void hold_move();
  [[gnu::cold]] Extent compensated_extent() const;
  [[gnu::cold]] Place beside() const;
  [[gnu::cold]] void settle();
  [[gnu::cold]] void go_beside();
  [[gnu::cold]] Fault leave_beside(Statement& statement, std::string_view line);
  static std::uint8_t digit_um(const Modal& modal);

  std::array<State, 2> states_;
  State* state_ = &states_[0];
  State* next_ = &states_[1];  ///< for the state after the next line
  Saved saved_;
  Plan plan_{};
  Curve curve_;
  CurveTiming share_;
  /// The pieces of a line.
  struct Pieces {
    std::array<char, PowerList::max_characters> text;
    PowerList powers;
    std::uint32_t returned;
  };
  /// Only one is in use: cutter compensation and the block of a NURBS exclude the others.
  union Work {
    Work() : cycle{} {}
    DrillCycle cycle;
    Pieces pieces;
    Compensation compensation;
    NurbsPoints nurbs;
  } work_;
  static_assert(sizeof(NurbsPoints) <= sizeof(Compensation));
  /// After G40 the machine is beside the programmed place, until the first move in the plane.
  struct Beside {
    PlanePoint distance_e7;
    std::uint8_t first, second;
    bool active;
  } beside_{};
  /// Compensation is on, or the machine is beside the programmed place, or lines are the user's.
  bool in_compensation_ = false;
  bool users_lines_ = false;                    ///< in a tool change
  std::uint8_t held_step_ = 0;                  ///< of what is released: the move, then the actions
  std::uint8_t ignored_ = 0, new_ignored_ = 0;  ///< in this program; not reported yet
  Parameters& parameters_;
  const Options& options_;
  Expressions expressions_{state_, parameters_, options_.rotary};
};

}  // namespace lamplock::program
