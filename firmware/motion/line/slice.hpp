// Lengths of the segments of the line planner.
#pragma once

#include <cstdint>

#include "shared/units.hpp"

namespace lamplock::motion {

/// Maximum where jerk is limited: a change of speed consists of pulses of at most this length, and
/// shorter ones have lower accelerations (line/rise.hpp).
inline constexpr std::uint32_t line_slice_ticks = 16 * (ticks_per_second / 1000);
/// Maximum elsewhere: a hold takes effect after the motion handed out and a batch of slices
/// (program_runner.hpp).
inline constexpr std::uint32_t steady_slice_ticks = 8 * (ticks_per_second / 1000);

}  // namespace lamplock::motion
