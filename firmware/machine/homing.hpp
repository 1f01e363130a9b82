// Homing: finds the limit switches, and with them where the machine is.
//
// In:  settings; each time the machine stands: where, which switches are engaged, what the guard of
//      the last move has met; that it is given up, and why.
// Out: the next move and what its guard watches, a wait, a position; or how it has ended.
// Who: the controller, main loop; nothing here takes time.
//
// Phases ($44 to $47: which axes home together) one after the other; where all limits are one
// circuit the axes of a phase go one by one. In a phase, as grbl 1.1 has it:
//
//   seek      towards the switches, at $25 per axis, until each has engaged; who is engaged already
//             stays
//   pull off  by $27 from where they did, at $25; they must have let go $26 later
//   locate    towards them again, at $24: the place of an axis is where it was when its switch
//             changed, however far it ran on while it braked
//   pull off  by $27 from that place; $43 times from locate to here
//
// A ganged axis (shared/kinematics.hpp) with a switch of its own for the second motor, that of A,
// is squared: each side of the gantry is homed as if it were an axis, and stands where its switch
// says. Once one side has met its switch the other goes on alone, before anything else, and no
// further than a gantry can be bent: 5 % of the travel, 2.5 to 25 mm, as in grbl 1.1. If just one
// side is engaged at the beginning both pull off first, so that a broken wire bends nothing. In
// here A is that side; move() and position() have the racking there, as all of the core does.
//
// The switch of an axis stands at the end of its work space: the upper one, with its bit in $23 the
// lower one. So the machine stands $27 inside of it in the end.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/machine/guard.hpp"
#include "shared/kinematics.hpp"
#include "shared/settings_table.hpp"
#include "shared/units.hpp"

namespace lamplock::machine {

/// A bit for each axis.
using AxisSet = std::uint8_t;

class Homing {
 public:
  /// What is to be done next.
  enum class Next : std::uint8_t {
    move,               ///< as move() says
    wait,               ///< standing, while waits()
    set_position,       ///< the machine stands at position(), then ask again
    done,               ///< all axes; end() is due, as behind what follows
    still_engaged,      ///< a switch does not let go
    switch_not_found,   ///< an axis has met no switch
    gantry_not_squared  ///< one side of it has, the other one not
  };
  struct Move {
    StepPosition target{};
    std::uint32_t feed_um_min = 0;  ///< along the path
    InputSet watch = 0;             ///< for becoming active
  };
  /// When the machine stands.
  struct Rest {
    StepPosition at{};
    InputSet active = 0;  ///< inputs, now
    const Guard& guard;   ///< of the last move
  };

  /// Axes of `wanted` that the machine has a switch for, in the phases of the settings; a single
  /// axis is homed whether it has a phase or not. False if there is none. `inputs`: of the board.
  /// `ganged_axis`: -1 = none.
  bool begin(const settings::Values& values, InputSet inputs, AxisSet wanted, int ganged_axis);
  void end() { active_ = false; }
  /// From begin() to end().
  bool active() const { return active_; }
  /// All axes were asked for, not a single one.
  bool of_machine() const { return of_machine_; }
  /// It goes no further: this alarm is due when the machine stands. The first one counts.
  void give_up(std::uint8_t alarm) {
    if (alarm_ == 0) alarm_ = alarm;
  }
  /// That alarm; 0 = it goes on.
  std::uint8_t alarm() const { return alarm_; }
  /// The axis that is squared, or -1.
  int squared_axis() const { return squared_axis_; }

  /// To be asked when the machine stands and a wait is over.
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
  /// Of the two sides of a gantry just one has found its switch.
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
  std::int32_t pull_off_milli_mm_ = 0, longest_travel_milli_mm_ = 0;
  std::int32_t passes_ = 1;
  PerAxis<std::int32_t> steps_per_mm_milli_{}, low_milli_mm_{}, high_milli_mm_{};

  std::int8_t squared_axis_ = -1;
  AxisSet sides_ = 0;  ///< that axis and A

  bool active_ = false, of_machine_ = false;
  std::uint8_t alarm_ = 0;
  std::uint64_t wait_end_ = 0;  ///< clock
  Stage stage_ = Stage::phase;
  int phase_ = 0;
  AxisSet left_ = 0;        ///< of the present phase mask, not homed
  AxisSet phase_axes_ = 0;  ///< homed together, now
  AxisSet found_ = 0;       ///< of those, in this approach
  AxisSet placed_ = 0;      ///< of those, whose switch has a place
  std::int32_t pass_ = 0;   ///< 0: seek; before that the sides of a gantry pull off
  StepPosition places_{};   ///< of the switches
  Move move_;
  StepPosition position_{};
};

}  // namespace lamplock::machine
