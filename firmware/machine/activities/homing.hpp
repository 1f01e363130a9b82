// Homing: finds the limit switches and from them the position of the machine.
//
// In:  settings; each time the machine is at rest: its position, active switches, the result of the
//      guard of the last move; an order to abort, with its alarm.
// Out: the next move and what its guard watches, a wait, a position; or the result.
// Who: the controller, main loop; all functions are short.
//
// Phases ($44 to $47: which axes home together) run in sequence; where all limits are one circuit
// the axes of a phase home one by one. In a phase, as in grbl 1.1:
//
//   seek      towards the switches, at $25 per axis, until each has engaged; an axis with an
//             engaged switch does not move
//   pull off  by $27 from there, at $25; the switches must have released $26 later
//   locate    towards them again, at $24: the position of an axis is taken when its switch changes,
//             not where it stops after braking
//   pull off  by $27 from that position; locate and this run $43 times
//
// A ganged axis (shared/kinematics.hpp) whose second motor has its own switch, that of A, is
// squared: each side of the gantry is homed like an axis, to the position given by its switch. Once
// one side has met its switch the other continues alone, before anything else, and no further than
// a gantry can be bent: 5 % of the travel, 2.5 to 25 mm, as in grbl 1.1. If just one side is
// engaged at the beginning both pull off first, so that a broken wire bends nothing. In this file A
// is that side; in move() and position() A is the racking, as in the rest of the core.
//
// The switch of an axis is at the upper end of its work space, or at the lower one if its bit in
// $23 is set. So the machine ends $27 inside of it.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/machine/inputs/move_guard.hpp"
#include "shared/kinematics.hpp"
#include "shared/settings_table.hpp"
#include "shared/units.hpp"

namespace lamplock::machine {

/// A bit for each axis.
using AxisSet = std::uint8_t;

class Homing {
 public:
  /// What the controller must do next.
  enum class Next : std::uint8_t {
    move,               ///< run move()
    wait,               ///< rest while waits()
    set_position,       ///< set the position to position(), then call next() again
    done,               ///< all axes; end() is due, as after the following
    still_engaged,      ///< a switch does not release
    switch_not_found,   ///< an axis has met no switch
    gantry_not_squared  ///< one side has met its switch, the other has not
  };
  struct Move {
    StepPosition target{};
    std::uint32_t feed_um_min = 0;  ///< along the path
    InputSet watch = 0;             ///< inputs that end the move when they become active
  };
  /// State of the machine at rest.
  struct Rest {
    StepPosition at{};
    InputSet active = 0;     ///< inputs, now
    const MoveGuard& guard;  ///< of the last move
  };

  /// Homes the axes of `wanted` that have a switch, in the phases of the settings; a single axis is
  /// homed whether it has a phase or not. False if there is none. `inputs`: of the board.
  /// `ganged_axis`: -1 = none.
  bool begin(const settings::Values& values, InputSet inputs, AxisSet wanted, int ganged_axis);
  void end() { active_ = false; }
  /// From begin() to end().
  bool active() const { return active_; }
  /// All axes were requested, not a single one.
  bool of_machine() const { return of_machine_; }
  /// Aborts: this alarm is due when the machine is at rest. The first one counts.
  void abort(std::uint8_t alarm) {
    if (alarm_ == 0) alarm_ = alarm;
  }
  /// That alarm; 0 = not aborted.
  std::uint8_t alarm() const { return alarm_; }
  /// The axis that is squared, or -1.
  int squared_axis() const { return squared_axis_; }

  /// The next action; to be called when the machine is at rest and a wait is over.
  Next next(const Rest& rest);
  const Move& move() const { return move_; }
  void wait_from(std::uint64_t clock) { wait_end_ = clock + wait_clocks_; }
  bool waits(std::uint64_t clock) const { return clock < wait_end_; }
  const StepPosition& position() const { return position_; }

 private:
  enum class Stage : std::uint8_t { phase, approached, pulled_off, check };
  static constexpr int phases = 4;

  bool next_phase();
  void square(int ganged_axis);
  Next next_of_sides(const Rest& rest);
  Next begin_phase(const Rest& rest);
  Next approach(const Rest& rest);
  Next approached(const Rest& rest);
  Next pull_off(const Rest& rest, AxisSet axes);
  Next check(const Rest& rest);
  /// Just one of the two sides of a gantry has found its switch.
  bool side_left() const {
    return (found_ & sides_) != 0 && (found_ & sides_) != (phase_axes_ & sides_);
  }
  std::int64_t way_milli_mm() const;
  void find_place(const StepPosition& at);
  bool downwards(int axis) const { return (downwards_ >> axis & 1u) != 0; }
  bool in_phase(int axis) const { return (phase_axes_ >> axis & 1u) != 0; }
  std::uint32_t path_feed(std::uint32_t axis_feed_um_min, AxisSet axes) const;
  std::int32_t steps(std::int64_t milli_mm, int axis) const;

  // From the settings.
  std::array<AxisSet, phases> phase_masks_{};
  AxisSet downwards_ = 0;
  bool chain_ = false;
  std::uint32_t seek_um_min_ = 0, locate_um_min_ = 0, wait_clocks_ = 0;
  std::int32_t pull_off_milli_mm_ = 0, max_travel_milli_mm_ = 0;
  std::int32_t passes_ = 1;
  PerAxis<std::int32_t> steps_per_mm_milli_{}, low_milli_mm_{}, high_milli_mm_{};

  std::int8_t squared_axis_ = -1;
  AxisSet sides_ = 0;  ///< that axis and A

  bool active_ = false, of_machine_ = false;
  std::uint8_t alarm_ = 0;
  std::uint64_t wait_end_ = 0;  ///< clock
  Stage stage_ = Stage::phase;
  int phase_ = 0;
  AxisSet left_ = 0;        ///< of the present phase mask, not homed yet
  AxisSet phase_axes_ = 0;  ///< homed together, now
  AxisSet found_ = 0;       ///< of phase_axes_, in this approach
  AxisSet placed_ = 0;      ///< of phase_axes_, with a position of their switch
  std::int32_t pass_ = 0;   ///< 0: seek; before that the sides of a gantry pull off
  StepPosition places_{};   ///< of the switches
  Move move_;
  StepPosition position_{};
};

}  // namespace lamplock::machine
