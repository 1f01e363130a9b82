// Chooses smooth speeds at the points, after their beats are known.
//
// In:  a window, its beats, and the boxes of speeds that they allow (beat_reduction.hpp).
// Out: one speed per point and axis such that every way can be run, with about the least sum over
//      the ways of time x peak acceleration squared.
// Who: the planner (main loop, or the core that plans); budget: some 2000 cycles per point and
//      axis.
//
// The motion with the least integral of acceleration squared through given points at given times is
// the natural cubic spline. Between ways of k and l beats with mean speeds s and t its speeds solve
//   l v_before + 2 (k + l) v + k v_after = 3 (l s + k t).
// Some sweeps over these equations, each speed limited to its box (projected Gauss-Seidel), find
// the least sum inside the boxes; a last pass backwards from the end joins every pair of speeds
// exactly.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/motion/free/beat_reduction.hpp"

namespace lamplock::motion {

using Speeds = std::array<PerAxis<std::int32_t>, window_points>;  ///< normalised and scaled

/// Chooses the speeds of one axis at the ends of all ways. `start_qs`: speed at the start.
void choose_smooth_speeds(const Window& window, const Improver& boxes,
                          const std::array<std::int32_t, window_points>& beats, int axis,
                          std::int32_t start_qs, Speeds& speeds_qs);

}  // namespace lamplock::motion
