// The limit switches that match a machine's settings.
//
// In:  the settings. Out: for a machine that homes ($22), a switch for each axis at the end of its
//      work space that $23 selects, with the polarity of $5, and one for the second side of a
//      gantry; the machine starts at its zero. No others, because switches slow a simulated board
//      down.
// Who: simulated boards of the command line that users operate.
#pragma once

#include <vector>

#include "shared/kinematics.hpp"
#include "shared/settings_table.hpp"
#include "shared/work_space.hpp"
#include "sim/world/switches.hpp"

namespace lamplock::sim {

inline std::vector<WireConfig> limits_of(const settings::Values& values) {
  using settings::Id;
  std::vector<WireConfig> wires;
  if (values.whole(Id::homing) == 0) return wires;
  const auto add = [&](int axis, int side, int input) {
    const std::int32_t low_milli = values.milli(Id::min_corner_x, axis);
    const std::int32_t high_milli = low_milli + values.milli(Id::travel_x, axis);
    const std::int32_t steps_per_mm = values.milli(Id::steps_per_mm_x, axis);
    const bool below = (values.whole(Id::homing_direction) >> axis & 1) != 0;
    const ContactConfig contact =
        below ? ContactConfig::below(side, steps_from_milli(low_milli, steps_per_mm))
              : ContactConfig::above(side, steps_from_milli(high_milli, steps_per_mm));
    wires.push_back({.pin = limit_pin(input),
                     .contacts = {contact},
                     .normally_closed = (values.whole(Id::limit_invert) >> input & 1) == 0});
  };
  for (int axis = 0; axis < values.whole(Id::axes); ++axis) add(axis, axis, axis);
  const Kinematics kinematics(values);
  constexpr int z = 2, side = Kinematics::gang_motor;
  if (kinematics.ganged_axis() >= 0)
    add(kinematics.ganged_axis(), side, second_switch_at_z(kinematics, values) ? z : side);
  return wires;
}

}  // namespace lamplock::sim
