// The laser's shots, as plain data for reports and comparisons.
#pragma once

#include <cstdint>
#include <vector>

#include "shared/units.hpp"
#include "sim/world/pins.hpp"

namespace lamplock::sim {

/// One release of the Q-switch, seen from the laser's side of the wire.
struct Shot {
  std::uint32_t index = 0;   ///< from 0, in order of firing
  std::uint8_t channel = 0;  ///< beam channel, 0 if no shutter is open
  std::int64_t beat = 0;     ///< number of the lamp flash, from 1; 0 = fired before any flash
  Picoseconds at = 0;        ///< start of the pulse
  StepPosition steps{};      ///< position of the drives at that time
  Picoseconds width = 0;     ///< 0 while the pulse lasts
  std::uint16_t energy = 0;  ///< at the attenuator
  friend bool operator==(const Shot&, const Shot&) = default;
};
using Shots = std::vector<Shot>;

}  // namespace lamplock::sim
