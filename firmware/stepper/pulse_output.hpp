// How the pulses of the axes leave a board, from the settings.
//
// In:  the settings $0, $2, $3, $1051 to $1054, $1075 to $1077.
// Out: meaning and inversion of the two wires of each axis; times in ticks.
// Who: boards. At their start: everything, for drives and cables do not change while the machine is
//      on. When settings change, at rest (Controller::take_settings()): the times.
#pragma once

#include <cstdint>

#include "firmware/stepper/reversal_guard.hpp"
#include "shared/pulse_times.hpp"
#include "shared/settings_table.hpp"
#include "shared/units.hpp"

namespace lamplock::stepper {

using settings::PulseMode;

/// The two wires of an axis.
struct AxisPulses {
  PulseMode mode = PulseMode::step_dir;
  bool first_inverted = false;   ///< STEP, CW or A
  bool second_inverted = false;  ///< DIR, CCW or B
};

struct PulseOutput {
  PerAxis<AxisPulses> axis{};
  PulseTimes pulses;
  DirectionTimes times;
};

/// From the settings. Times are rounded up to whole ticks of the shortest length. DIR does not
/// change during a pulse, and the steps before and after its change are as far apart as any two.
[[gnu::cold]] PulseOutput pulse_output(const settings::Values& values);

/// Levels of A (1) and B (2) after this many steps: 00, 10, 11, 01 (A B) upwards.
constexpr std::uint32_t quadrature_levels(std::uint32_t steps) {
  return ((steps ^ steps >> 1) & 1) | (steps & 2);
}

}  // namespace lamplock::stepper
