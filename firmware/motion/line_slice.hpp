// How long the segments of the line planner are.
#pragma once

#include <cstdint>

#include "shared/units.hpp"

namespace lamplock::motion {

/// The longest where jerk is limited: a change of speed consists of pulses no longer than that, and
/// shorter ones have lower accelerations (line_rise.hpp).
inline constexpr std::uint32_t line_slice_ticks = 16 * (ticks_per_second / 1000);
/// The longest elsewhere: a hold is in force after what is handed out and a batch of them
/// (program_runner.hpp).
inline constexpr std::uint32_t steady_slice_ticks = 8 * (ticks_per_second / 1000);

}  // namespace lamplock::motion
