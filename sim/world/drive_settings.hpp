// The drives that a machine's settings are made for.
//
// In:  the settings. Out: drives that read the two wires of each axis as the machine drives them,
//      have the enables of its pin map, want the set-up and hold time and the time to wake that it
//      keeps, and nothing more than that, and move what its motors are coupled to. Who: simulated
//      boards of the command line and of tests.
#pragma once

#include "firmware/machine/drive_rest.hpp"
#include "shared/boards/pico_pins.hpp"
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
  // A board may be a round of its main loop later at the pin than it thinks.
  constexpr double most_round_ms = 3;
  drives.wake_ms = machine::drive_wake_ms - most_round_ms;
  drives.axes_of_enable_z =
      boards::axes_of_z_enable(static_cast<boards::PinMap>(values.whole(Id::pin_map)));
  return drives;
}
static_assert(static_cast<int>(PulseMode::cw_ccw) == static_cast<int>(settings::PulseMode::cw_ccw));
static_assert(static_cast<int>(PulseMode::quadrature) ==
              static_cast<int>(settings::PulseMode::quadrature));

}  // namespace lamplock::sim
