// How far ahead of the ticks lines of a program are handed out.
//
// Who: the program runner, and whoever wants to plan as it does without a clock.
#pragma once

#include <cstdint>

#include "shared/units.hpp"

namespace lamplock::machine {

/// Handed out ahead of the ticks that are filled: what a slow main loop and a batch may take
/// together, and not more than a hold and overrides can wait.
inline constexpr std::uint64_t horizon_ticks = 16 * (ticks_per_second / 1000);
/// Motion is begun this long after the ticks already filled.
inline constexpr std::uint64_t start_margin_ticks = ticks_per_second / 2000;

}  // namespace lamplock::machine
