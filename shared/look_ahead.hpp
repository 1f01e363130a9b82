// How far the planner looks ahead in a job of points: for the planner, and for hosts that keep
// enough points in the board.
#pragma once

#include <cstdint>

namespace lamplock {

/// Points planned at once: a window.
inline constexpr std::uint32_t window_points = 36;

/// Points after a window that the planner examines for the length of a row
/// (firmware/motion/free/run_up.hpp).
inline constexpr std::uint32_t run_horizon = 256;

}  // namespace lamplock
