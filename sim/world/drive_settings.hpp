// The drives that match a machine's settings.
//
// In:  the settings. Out: drives that read the two wires of each axis as the machine drives them,
//      have the enables of its pin map, need exactly the pulse, set-up, hold and wake times that it
//      keeps, and move what its motors are coupled to. Who: simulated boards of the command line
//      and of tests.
#pragma once

#include "shared/boards/all_boards.hpp"
#include "shared/drive_times.hpp"
#include "shared/settings_table.hpp"
#include "sim/world/drives.hpp"

namespace lamplock::sim {

inline DriveConfig drives_of(const settings::Values& values) {
  using settings::Id;
  DriveConfig drives;
  for (int axis = 0; axis < max_axes; ++axis) {
    // The numbers have the same meaning on both ends of the wire.
    drives.mode[index(axis)] = static_cast<PulseMode>(values.whole(Id::pulse_mode_x, axis));
    drives.first_active_low[index(axis)] = (values.whole(Id::step_invert) >> axis & 1) != 0;
    drives.second_active_low[index(axis)] = (values.whole(Id::direction_invert) >> axis & 1) != 0;
  }
  drives.kinematics = Kinematics(values);
  drives.min_pulse_ns = values.milli(Id::step_pulse);
  drives.min_low_ns = values.milli(Id::step_low);
  drives.dir_setup_ns = values.milli(Id::direction_setup);
  drives.dir_hold_ns = values.milli(Id::direction_hold);
  // The pin of a board may change up to a round of its main loop later than the board assumes.
  constexpr double max_round_ms = 3;
  drives.wake_ms = drive_wake_ms - max_round_ms;
  drives.axes_of_enable_z =
      boards::axes_of_z_enable(static_cast<boards::PinMap>(values.whole(Id::pin_map)));
  return drives;
}
static_assert(static_cast<int>(PulseMode::cw_ccw) == static_cast<int>(settings::PulseMode::cw_ccw));
static_assert(static_cast<int>(PulseMode::quadrature) ==
              static_cast<int>(settings::PulseMode::quadrature));

}  // namespace lamplock::sim
