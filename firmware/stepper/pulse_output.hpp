// How the pulses of the axes leave a board, from the settings.
//
// In:  the settings that a board starts with ($2, $3, $1051 to $1054, $1075, $1076).
// Out: meaning and inversion of the two wires of each axis, and times in ticks.
// Who: boards, once, at their start: drives and cables do not change while the machine is on.
#pragma once

#include <cstdint>

#include "firmware/stepper/reversal_guard.hpp"
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
  DirectionTimes times;
};

/// From the settings. Times are rounded up to whole ticks of the shortest length.
[[gnu::cold]] PulseOutput pulse_output(const settings::Values& values);

/// Levels of A (1) and B (2) after this many steps: 00, 10, 11, 01 (A B) upwards.
constexpr std::uint32_t quadrature_levels(std::uint32_t steps) {
  return ((steps ^ steps >> 1) & 1) | (steps & 2);
}

}  // namespace lamplock::stepper
