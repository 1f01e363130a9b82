// How far the planner looks ahead in a job of points: for the planner, and for hosts that keep
// enough points in the board.
#pragma once

#include <cstdint>

namespace lamplock {

/// Points planned at once: a window.
inline constexpr std::uint32_t window_points = 36;

/// Maximum segments made of a window; the points after them are the look-ahead. Four are enough:
/// with more of them the plans are no shorter.
inline constexpr std::uint32_t commit_points = window_points - 4;

/// Points after a window that the planner examines for the length of a row
/// (firmware/motion/free/run_up.hpp).
inline constexpr std::uint32_t run_horizon = 256;

}  // namespace lamplock
