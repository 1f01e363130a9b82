// The motor drives: integrate pulses into positions and count pulses that a real drive would lose.
//
// In:  the two wires of each of four axes, as the axis is set: STEP and DIR (a rising edge of STEP
//      moves one step, DIR high is negative), CW and CCW (a rising edge of CW is a step up, of CCW
//      a step down), or A and B in quadrature (every edge is a step; up while A leads).
//      The changes of one axis come in order of time; axes may come one after the other.
// Out: the position of the loads that the motors move (shared/kinematics.hpp: X and Y of a CoreXY,
//      each side of a gantry with two motors by itself), now or at a recent time; each step,
//      reported to listeners; and counts of pulses that a real drive would have lost without
//      notice: too short, too fast, DIR changed too close to STEP, both CW and CCW high, quadrature
//      that jumps by two, steps while its enable is low (an enable that has never been high is
//      taken as not wired).
// The load follows the steps late, by a pure delay of its axis: servo, filter or closed loop.
// A drive is a motor; loads are X, Y, Z and A, which is the second side of a gantry. A gantry that
// is not square at power-up has a start of A that differs from that of its axis.
// Positions are steps from the machine's own zero, which switches refer to. At power-up the load is
// where the configuration says; a controller that has not homed counts from there.
// Who: the bus calls pin_changed() for every edge; no allocation, a few nanoseconds.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "shared/kinematics.hpp"
#include "shared/units.hpp"
#include "sim/world/pins.hpp"

namespace lamplock::sim {

/// Meaning of the two wires of an axis.
enum class PulseMode : std::uint8_t {
  step_dir,    ///< STEP, DIR
  cw_ccw,      ///< CW on the wire of STEP, CCW on that of DIR
  quadrature,  ///< A on the wire of STEP, B on that of DIR
};

/// Limits of the drives.
struct DriveConfig {
  double min_pulse_ns = 400;   ///< a pulse (quadrature: any level of one wire)
  double min_low_ns = 0;       ///< from the end of a pulse to the next one of the same wire
  double min_period_ns = 900;  ///< step to step
  double dir_setup_ns = 200;   ///< DIR stable before the rising edge of STEP; CW low before
                               ///< the rising edge of CCW and the other way round
  double dir_hold_ns = 0;      ///< DIR stable after the rising edge of STEP
  double wake_ms = 0;          ///< time from enable until a drive takes steps
  /// Axes whose enable is Pin::enable_z, a bit for each.
  unsigned axes_of_enable_z = 0;
  double quadrature_gap_ns = 100;     ///< edges of A and B closer than this count as one jump
  PerAxis<double> lag_us{};           ///< STEP to movement of the load
  PerAxis<PulseMode> mode{};          ///< meaning of the wires
  PerAxis<bool> first_active_low{};   ///< STEP, CW or A is inverted
  PerAxis<bool> second_active_low{};  ///< DIR, CCW or B is inverted
  Kinematics kinematics{};            ///< which motors move which loads
  StepPosition start{};               ///< position of the loads at power-up
};

/// Pulses outside the limits of a drive. They are counted as steps all the same.
struct DriveFaults {
  std::uint64_t short_pulses = 0;
  std::uint64_t short_pauses = 0;  ///< between two pulses of a wire
  std::uint64_t fast_steps = 0;
  std::uint64_t late_directions = 0;    ///< too close before the step
  std::uint64_t unheld_directions = 0;  ///< too close after the step
  std::uint64_t both_high = 0;          ///< CW and CCW
  std::uint64_t quadrature_jumps = 0;   ///< A and B together
  std::uint64_t unpowered_steps = 0;    ///< while the drive was released, or had just been enabled
  std::uint64_t total() const {
    return short_pulses + short_pauses + fast_steps + late_directions + unheld_directions +
           both_high + quadrature_jumps + unpowered_steps;
  }
  friend bool operator==(const DriveFaults&, const DriveFaults&) = default;
};

/// Receives the steps of one axis, for a switch or an encoder on its load.
class LoadListener {
 public:
  virtual ~LoadListener() = default;
  /// Called for each step when its pulse comes; the load is at `place` from `at` on. In order of
  /// time for each motor, and so for each axis that has its own motor; with a lag `at` is later
  /// than the pulse.
  virtual void load_moves(int axis, std::int32_t place, Picoseconds at) = 0;
};

/// Four drives; must live as long as the bus is driven.
class Drives final : public PinListener {
 public:
  Drives(const DriveConfig& config, PinBus& bus);
  Drives(const Drives&) = delete;
  Drives& operator=(const Drives&) = delete;

  /// Where all pulses so far take the loads.
  StepPosition position() const;

  /// Position of the loads after all their motion up to and including `at`. Reaches back
  /// `remembered_steps` steps per axis; before that it returns the oldest position kept.
  StepPosition position_at(Picoseconds at) const;

  /// Where all pulses so far take the motors, in steps.
  StepPosition motors() const;

  const DriveFaults& faults(int axis) const { return axes_[index(axis)].faults; }
  std::uint64_t total_faults() const;
  /// Delay between step and load of an axis.
  Picoseconds lag(int axis) const { return axes_[index(axis)].lag; }
  /// Shortest time between two steps that a drive follows.
  Picoseconds min_period() const { return min_period_; }

  /// Reports the steps of one axis from now on; the listener must live as long as the drives.
  void listen(int axis, LoadListener& listener) {
    axes_[index(axis)].listeners.push_back(&listener);
    axes_[index(axis)].heard = true;
    // Either of the two motors moves both loads.
    if (kinematics_.core_xy() && axis < 2) axes_[0].heard = axes_[1].heard = true;
  }

  void pin_changed(Pin pin, bool level, Picoseconds at) override {
    if (pin == Pin::enable || pin == Pin::enable_z) return power(pin, level, at);
    const auto line = static_cast<std::size_t>(pin);
    Axis& axis = axes_[line / 2];
    if (!axis.plain)
      special_changed(axis, line % 2, level, at);
    else if (line % 2 != 0)
      turn(axis, level, at);
    else if (level)
      step(axis, at);
    else
      fall(axis, at);
  }

  static constexpr std::size_t remembered_steps = 4096;

 private:
  /// Long before power-up, yet far enough from the limits to subtract.
  static constexpr Picoseconds long_ago = std::numeric_limits<Picoseconds>::min() / 2;
  struct Step {
    Picoseconds at = long_ago;
    std::int32_t position_before = 0;
  };
  struct Axis {
    std::int32_t position = 0;
    std::int32_t direction = 1;
    std::uint32_t steps = 0;  ///< wraps; a multiple of remembered_steps fits
    int number = 0;
    bool plain = true;   ///< STEP and DIR, not inverted
    bool heard = false;  ///< there are listeners
    PulseMode mode = PulseMode::step_dir;
    std::array<bool, 2> inverted{};
    std::array<bool, 2> active{};
    Picoseconds last_step = long_ago;
    Picoseconds last_fall = long_ago;  ///< of STEP
    Picoseconds last_turn = long_ago;
    std::array<Picoseconds, 2> last_change{long_ago, long_ago};  ///< of the other modes
    Picoseconds lag = 0;
    bool released = false;
    Picoseconds powered = long_ago;  ///< takes steps from then on
    DriveFaults faults;
    std::vector<LoadListener*> listeners;
    std::array<Step, remembered_steps> recent;
  };

  void turn(Axis& axis, bool negative, Picoseconds at) const {
    axis.direction = negative ? -1 : 1;
    axis.last_turn = at;
    if (at - axis.last_step < dir_hold_) ++axis.faults.unheld_directions;
  }
  void step(Axis& axis, Picoseconds at) {
    if (at - axis.last_turn < dir_setup_) ++axis.faults.late_directions;
    if (at - axis.last_fall < min_low_) ++axis.faults.short_pauses;
    move(axis, axis.direction, at);
  }
  void fall(Axis& axis, Picoseconds at) const {
    axis.last_fall = at;
    if (at - axis.last_step < min_pulse_) ++axis.faults.short_pulses;
  }
  void move(Axis& axis, std::int32_t way, Picoseconds at) {
    if (at - axis.last_step < min_period_) ++axis.faults.fast_steps;
    if (axis.released || at < axis.powered) ++axis.faults.unpowered_steps;
    axis.last_step = at;
    axis.recent[axis.steps++ % remembered_steps] = {at, axis.position};
    axis.position += way;
    if (axis.heard) report(axis, way, at);
  }
  void report(const Axis& axis, std::int32_t way, Picoseconds at) const;
  void power(Pin pin, bool on, Picoseconds at);
  void special_changed(Axis& axis, std::size_t wire, bool level, Picoseconds at);
  void pulse_changed(Axis& axis, std::size_t wire, bool active, Picoseconds at);
  void quadrature_changed(Axis& axis, std::size_t wire, bool active, Picoseconds at);

  Picoseconds min_pulse_;
  Picoseconds min_low_;
  Picoseconds min_period_;
  Picoseconds dir_setup_;
  Picoseconds dir_hold_;
  Picoseconds quadrature_gap_;
  Picoseconds wake_;
  unsigned axes_of_enable_z_;
  Kinematics kinematics_;
  PerAxis<Axis> axes_{};
};

}  // namespace lamplock::sim
