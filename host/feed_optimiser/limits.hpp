// Limits of the axes, and what they permit along one block.
//
// In:  numbers of the user. Out: limits along the path. Who: blocks and profiles.
#pragma once

#include <array>
#include <cstddef>

namespace lamplock::feed_optimiser {

inline constexpr std::size_t axes = 3;  ///< X, Y and Z
using PerAxis = std::array<double, axes>;

/// Limits of each axis.
struct AxisLimits {
  PerAxis speed_mm_s{}, accel_mm_s2{}, jerk_mm_s3{};
};

/// Throws Error(bad_input) unless all are positive and finite.
void require_limits(const AxisLimits& limits);

/// Limits of the motion along a path.
struct PathLimits {
  double speed_mm_s = 0, accel_mm_s2 = 0, jerk_mm_s3 = 0;
};

}  // namespace lamplock::feed_optimiser
