// Kinematics: which motors move which axes. One definition for firmware, simulator and host.
//
// In:  the settings $965 and $966.
// Out: positions of motors from those of axes, and back.
// Who: the tick generator, the only place that converts runs of axes to runs of motors; code that
//      reads positions back from motors (the controller: dead stops, contacts); the drives of the
//      simulated world, which move loads by motors; traces of the output.
//
// Planning, braking, limits, homing and reports all use axes. Usually a motor is the motor of one
// axis. Otherwise two axes share two motors, a pair:
//
//   CoreXY   motor X = X + Y, motor Y = X - Y
//   ganged   one motor of the axis G is its own, the other one is that of A: A = G + racking. The
//            plan of axis A is only the racking: 0, except while homing squares the gantry.
//
// An axis at rest is in the middle of a step, half a step above its lower edge. The sum of two
// halves would be an edge, so motors of a pair have an offset of half a step: then they, too, rest
// in the middle. At rest the positions of both motors of a CoreXY are even or both are odd. After a
// dead stop one may be even and the other odd; then X and Y are on edges of their steps, and the
// next motion begins there.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "shared/settings_table.hpp"
#include "shared/units.hpp"

namespace lamplock {

/// Two axes that share two motors of the same numbers.
struct AxisPair {
  enum class Kind : std::uint8_t { core, ganged };
  Kind kind = Kind::core;
  std::uint8_t first = 0, second = 0;

  constexpr int motor(bool of_second) const { return of_second ? second : first; }

  /// First motor from both axes; for positions less their offsets, rates, accelerations.
  template <class T>
  constexpr T first_motor(const T& u, const T& v) const {
    return kind == Kind::core ? u + v : u;
  }
  /// The same for the second motor.
  template <class T>
  constexpr T second_motor(const T& u, const T& v) const {
    return kind == Kind::core ? u - v : u + v;
  }
};

/// The kinematics of one machine.
class Kinematics {
 public:
  /// Every axis has its own motor.
  constexpr Kinematics() = default;
  /// From the settings; contradictory settings count as none (broken_kinematics()).
  explicit constexpr Kinematics(const settings::Values& values) {
    using settings::Id;
    const int axes = values.whole(Id::axes);
    const int ganged = values.whole(Id::ganged_axis) - 1;
    if (values.milli(Id::kinematics) != 0 && axes >= 2) add({AxisPair::Kind::core, 0, 1});
    if (ganged < 0 || ganged >= axes || axes == max_axes || (core_xy() && ganged < 2)) return;
    add({AxisPair::Kind::ganged, static_cast<std::uint8_t>(ganged), gang_motor});
    ganged_ = static_cast<std::int8_t>(ganged);
  }

  /// The second motor of a ganged axis.
  static constexpr std::uint8_t gang_motor = max_axes - 1;

  constexpr std::span<const AxisPair> pairs() const { return {pairs_.data(), count_}; }
  /// There are pairs.
  constexpr bool coupled() const { return count_ != 0; }
  constexpr bool core_xy() const { return count_ != 0 && pairs_[0].kind == AxisPair::Kind::core; }
  /// The axis with two motors, or -1.
  constexpr int ganged_axis() const { return ganged_; }
  constexpr bool in_pair(int axis) const { return (paired_ >> axis & 1u) != 0; }

  /// Positions of the motors for axes at rest.
  constexpr StepPosition motors_of(const StepPosition& axes) const {
    StepPosition motors = axes;
    for (const AxisPair& pair : pairs()) {
      motors[pair.first] = pair.first_motor(axes[pair.first], axes[pair.second]);
      motors[pair.second] = pair.second_motor(axes[pair.first], axes[pair.second]);
    }
    return motors;
  }
  /// Positions of the loads that motors move: X, Y and Z, and each side of a gantry separately, as
  /// seen by its switch. On an edge, the step above it.
  constexpr StepPosition loads_of(const StepPosition& motors) const {
    StepPosition loads = motors;
    if (!core_xy()) return loads;
    loads[0] = (motors[0] + motors[1] + 1) >> 1;
    loads[1] = (motors[0] - motors[1] + 1) >> 1;
    return loads;
  }
  /// Positions of the motors for these loads.
  constexpr StepPosition motors_of_loads(const StepPosition& loads) const {
    StepPosition motors = loads;
    if (!core_xy()) return motors;
    motors[0] = loads[0] + loads[1];
    motors[1] = loads[0] - loads[1];
    return motors;
  }
  friend constexpr bool operator==(const Kinematics& a, const Kinematics& b) {
    return a.core_xy() == b.core_xy() && a.ganged_ == b.ganged_;
  }

 private:
  constexpr void add(const AxisPair& pair) {
    pairs_[count_++] = pair;
    paired_ = static_cast<std::uint8_t>(paired_ | 1u << pair.first | 1u << pair.second);
  }

  std::array<AxisPair, 2> pairs_{};
  std::uint8_t count_ = 0;
  std::uint8_t paired_ = 0;  ///< axes, a bit for each
  std::int8_t ganged_ = -1;
};

/// The limit switch of a gantry's second side is at the input of A; on a machine without Z at that
/// of Z, because boards have three such inputs rather than four.
constexpr bool second_switch_at_z(const Kinematics& kinematics, const settings::Values& values) {
  return kinematics.ganged_axis() >= 0 && values.whole(settings::Id::axes) == 2;
}

/// Changes the settings to the active kinematics: it changes only at a start.
constexpr void put_in_force(const Kinematics& kinematics, settings::Values& values) {
  using settings::Id;
  values.set_milli(Id::kinematics, kinematics.core_xy() ? 1000 : 0);
  values.set_milli(Id::ganged_axis, (kinematics.ganged_axis() + 1) * 1000);
}

/// Number of the setting that contradicts the requested kinematics; 0 = none.
constexpr std::uint16_t broken_kinematics(const settings::Values& values) {
  using settings::Id;
  const bool core = values.milli(Id::kinematics) != 0;
  const int axes = values.whole(Id::axes), ganged = values.whole(Id::ganged_axis) - 1;
  if (core && axes < 2) return settings::number(Id::kinematics);
  // Both motors turn for each axis: their steps per mm must be equal.
  if (core && values.milli(Id::steps_per_mm_x) != values.milli(Id::steps_per_mm_y))
    return settings::number(Id::steps_per_mm_y);
  if (ganged < 0) return 0;
  const bool taken = axes == max_axes || ganged >= axes || (core && ganged < 2);
  return taken ? settings::number(Id::ganged_axis) : 0;
}

}  // namespace lamplock
