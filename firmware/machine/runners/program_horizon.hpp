// How far ahead of the ticks lines of a program are handed out.
//
// Who: the program runner, and planning without a clock that must give the same result.
#pragma once

#include <cstdint>

#include "shared/units.hpp"

namespace lamplock::machine {

/// Motion handed out ahead of the filled ticks: the time of a slow main loop plus a batch, and the
/// most by which a hold or an override may be delayed.
inline constexpr std::uint64_t horizon_ticks = 16 * (ticks_per_second / 1000);
/// Motion begins this long after the ticks already filled.
inline constexpr std::uint64_t start_margin_ticks = ticks_per_second / 2000;

}  // namespace lamplock::machine
