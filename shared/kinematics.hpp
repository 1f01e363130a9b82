// Kinematics: which motors move which axes. One definition for firmware, simulator and host.
//
// In:  the settings $965 and $966.
// Out: places of motors from those of axes, and back.
// Who: the tick generator, which alone makes motors' runs out of axes'; whoever reads places back
//      from motors (the controller: dead stops, contacts); the drives of the simulated world, which
//      turn motors into loads; traces of what was put out.
//
// Planning, braking, limits, homing and reports are all in axes. As a rule motor and axis are the
// same. Where they are not, two axes share two motors, a pair:
//
//   CoreXY   motor X = X + Y, motor Y = X - Y
//   ganged   one motor of the axis G is its own, the other one is that of A: A = G + racking. What
//            is planned as axis A is the racking alone: 0, but while homing squares the gantry.
//
// An axis at rest stands in the middle of a step, half a step above its lower edge. The sum of two
// halves would be an edge, so motors of a pair have an offset of half a step: then they, too, rest
// in the middle. At rest both motors of a CoreXY have even places or both have odd ones. Stopped
// dead they may have one of each; then X and Y stand on edges of their steps, and whatever moves
// them next begins there.
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

  /// Of places less their offsets, rates, accelerations: what the first motor makes of both axes.
  template <class T>
  constexpr T first_motor(const T& u, const T& v) const {
    return kind == Kind::core ? u + v : u;
  }
  /// The same of the second.
  template <class T>
  constexpr T second_motor(const T& u, const T& v) const {
    return kind == Kind::core ? u - v : u + v;
  }
};

/// Of one machine.
class Kinematics {
 public:
  /// Every axis has its motor.
  constexpr Kinematics() = default;
  /// As the settings have it; what contradicts itself is none (broken_kinematics()).
  explicit constexpr Kinematics(const settings::Values& values) {
    using settings::Id;
    const int axes = values.whole(Id::axes);
    const int ganged = values.whole(Id::ganged_axis) - 1;
    if (values.milli(Id::kinematics) != 0 && axes >= 2) add({AxisPair::Kind::core, 0, 1});
    if (ganged < 0 || ganged >= axes || axes == max_axes || (core_xy() && ganged < 2)) return;
    add({AxisPair::Kind::ganged, static_cast<std::uint8_t>(ganged), gang_motor});
    ganged_ = static_cast<std::int8_t>(ganged);
  }

  /// The motor that a ganged axis has besides its own.
  static constexpr std::uint8_t gang_motor = max_axes - 1;

  constexpr std::span<const AxisPair> pairs() const { return {pairs_.data(), count_}; }
  /// There are pairs.
  constexpr bool coupled() const { return count_ != 0; }
  constexpr bool core_xy() const { return count_ != 0 && pairs_[0].kind == AxisPair::Kind::core; }
  /// The axis with two motors, or -1.
  constexpr int ganged_axis() const { return ganged_; }
  constexpr bool in_pair(int axis) const { return (paired_ >> axis & 1u) != 0; }

  /// Of an axis at rest.
  constexpr StepPosition motors_of(const StepPosition& axes) const {
    StepPosition motors = axes;
    for (const AxisPair& pair : pairs()) {
      motors[pair.first] = pair.first_motor(axes[pair.first], axes[pair.second]);
      motors[pair.second] = pair.second_motor(axes[pair.first], axes[pair.second]);
    }
    return motors;
  }
  /// Where the loads are that motors move: X, Y and Z, and each side of a gantry by itself, as its
  /// switch sees it. On an edge, the step above it.
  constexpr StepPosition loads_of(const StepPosition& motors) const {
    StepPosition loads = motors;
    if (!core_xy()) return loads;
    loads[0] = (motors[0] + motors[1] + 1) >> 1;
    loads[1] = (motors[0] - motors[1] + 1) >> 1;
    return loads;
  }
  /// The motors that put loads there.
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
/// of Z, for boards have three such inputs rather than four.
constexpr bool second_switch_at_z(const Kinematics& kinematics, const settings::Values& values) {
  return kinematics.ganged_axis() >= 0 && values.whole(settings::Id::axes) == 2;
}

/// The settings as they are where this kinematics is in force: it changes at a start alone.
constexpr void put_in_force(const Kinematics& kinematics, settings::Values& values) {
  using settings::Id;
  values.set_milli(Id::kinematics, kinematics.core_xy() ? 1000 : 0);
  values.set_milli(Id::ganged_axis, (kinematics.ganged_axis() + 1) * 1000);
}

/// Number of the setting that does not go with the kinematics that is asked for; 0 = none.
constexpr std::uint16_t broken_kinematics(const settings::Values& values) {
  using settings::Id;
  const bool core = values.milli(Id::kinematics) != 0;
  const int axes = values.whole(Id::axes), ganged = values.whole(Id::ganged_axis) - 1;
  if (core && axes < 2) return settings::number(Id::kinematics);
  // Both motors turn for either axis: a step of one is a step of the other.
  if (core && values.milli(Id::steps_per_mm_x) != values.milli(Id::steps_per_mm_y))
    return settings::number(Id::steps_per_mm_y);
  if (ganged < 0) return 0;
  const bool taken = axes == max_axes || ganged >= axes || (core && ganged < 2);
  return taken ? settings::number(Id::ganged_axis) : 0;
}

}  // namespace lamplock
