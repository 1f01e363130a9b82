// How long the segments of the line planner are.
#pragma once

#include <cstdint>

#include "shared/units.hpp"

namespace lamplock::motion {

/// The longest: with two of them handed out ahead, overrides are in force within 50 ms.
inline constexpr std::uint32_t line_slice_ticks = 16 * (ticks_per_second / 1000);

}  // namespace lamplock::motion
