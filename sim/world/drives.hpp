// The motor drives: integrate STEP/DIR into positions and complain as real drives would (silently).
//
// In:  STEP and DIR of four axes. A rising edge of STEP moves one step, DIR high is negative.
//      The changes of one axis come in order of time; axes may come one after the other.
// Out: the position of the load, now or at a time not long ago, and counts of pulses that a real
//      drive would have lost: too short, too fast, DIR changed too close before STEP.
// The load follows the steps late, by a pure delay of its axis: servo, filter or closed loop.
// Who: the bus calls pin_changed() for every edge; no allocation, a few nanoseconds.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "shared/units.hpp"
#include "sim/world/pins.hpp"

namespace lamplock::sim {

/// What the drives can follow.
struct DriveConfig {
  double min_pulse_ns = 400;   ///< STEP high
  double min_period_ns = 900;  ///< rising edge to rising edge
  double dir_setup_ns = 200;   ///< DIR stable before the rising edge of STEP
  PerAxis<double> lag_us{};    ///< STEP to movement of the load
};

/// Pulses outside what a drive can follow. They are counted as steps all the same.
struct DriveFaults {
  std::uint64_t short_pulses = 0;
  std::uint64_t fast_steps = 0;
  std::uint64_t late_directions = 0;
  std::uint64_t total() const { return short_pulses + fast_steps + late_directions; }
  friend bool operator==(const DriveFaults&, const DriveFaults&) = default;
};

/// Four drives; must live as long as the bus is driven.
class Drives final : public PinListener {
 public:
  Drives(const DriveConfig& config, PinBus& bus);
  Drives(const Drives&) = delete;
  Drives& operator=(const Drives&) = delete;

  /// Steps counted since power-up.
  StepPosition position() const;

  /// Load just after everything that has moved it up to and including `at`. Reaches back
  /// `remembered_steps` steps per axis; further back it gives the oldest position it knows.
  StepPosition position_at(Picoseconds at) const;

  const DriveFaults& faults(int axis) const { return axes_[static_cast<std::size_t>(axis)].faults; }
  std::uint64_t total_faults() const;
  /// How late the load of an axis follows.
  Picoseconds lag(int axis) const { return lag_[static_cast<std::size_t>(axis)]; }

  void pin_changed(Pin pin, bool level, Picoseconds at) override {
    const auto line = static_cast<std::size_t>(pin);
    Axis& axis = axes_[line / 2];
    if (line % 2 != 0)
      turn(axis, level, at);
    else if (level)
      step(axis, at);
    else if (at - axis.last_rise < min_pulse_)
      ++axis.faults.short_pulses;
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
    Picoseconds last_rise = long_ago;
    Picoseconds last_turn = long_ago;
    DriveFaults faults;
    std::array<Step, remembered_steps> recent;
  };

  static void turn(Axis& axis, bool level, Picoseconds at) {
    axis.direction = level ? -1 : 1;
    axis.last_turn = at;
  }
  void step(Axis& axis, Picoseconds at) {
    if (at - axis.last_rise < min_period_) ++axis.faults.fast_steps;
    if (at - axis.last_turn < dir_setup_) ++axis.faults.late_directions;
    axis.last_rise = at;
    axis.recent[axis.steps++ % remembered_steps] = {at, axis.position};
    axis.position += axis.direction;
  }

  Picoseconds min_pulse_;
  Picoseconds min_period_;
  Picoseconds dir_setup_;
  PerAxis<Picoseconds> lag_{};
  PerAxis<Axis> axes_{};
};

}  // namespace lamplock::sim
