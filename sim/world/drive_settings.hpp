// The drives that a machine's settings are made for.
//
// In:  the settings. Out: drives that read the two wires of each axis as the machine drives them,
//      want the set-up and hold time that it keeps, and nothing more than that, and move what its
//      motors are coupled to. Who: simulated
//      boards of the command line and of tests.
#pragma once

#include "shared/settings_table.hpp"
#include "sim/world/drives.hpp"

namespace lamplock::sim {

inline DriveConfig drives_of(const settings::Values& values) {
  using settings::Id;
  DriveConfig drives;
  for (int axis = 0; axis < max_axes; ++axis) {
    // The same numbers mean the same on both ends of the wire.
    drives.mode[index(axis)] = static_cast<PulseMode>(values.whole(Id::pulse_mode_x, axis));
    drives.first_active_low[index(axis)] = (values.whole(Id::step_invert) >> axis & 1) != 0;
    drives.second_active_low[index(axis)] = (values.whole(Id::direction_invert) >> axis & 1) != 0;
  }
  drives.kinematics = Kinematics(values);
  drives.dir_setup_ns = values.milli(Id::direction_setup);
  drives.dir_hold_ns = values.milli(Id::direction_hold);
  return drives;
}
static_assert(static_cast<int>(PulseMode::cw_ccw) == static_cast<int>(settings::PulseMode::cw_ccw));
static_assert(static_cast<int>(PulseMode::quadrature) ==
              static_cast<int>(settings::PulseMode::quadrature));

}  // namespace lamplock::sim
