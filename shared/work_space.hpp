// The work space in steps, from the settings: one rule for the host that rounds points and the
// firmware that refuses them.
#pragma once

#include <cstdint>

#include "shared/settings_table.hpp"
#include "shared/units.hpp"

namespace lamplock {

/// Lowest and highest position of each axis, both included [steps].
struct StepLimits {
  StepPosition min{};
  StepPosition max{};

  constexpr bool contains(int axis, std::int32_t steps) const {
    const auto i = static_cast<std::size_t>(axis);
    return min[i] <= steps && steps <= max[i];
  }
};

/// Steps nearest to a length in thousandths of a millimetre, half away from zero. With the ranges
/// of the settings table (3e6 x 5e7 / 1e6 = 1.5e8 steps) it cannot overflow.
constexpr std::int32_t steps_from_milli(std::int64_t milli_mm, std::int32_t milli_steps_per_mm) {
  const std::int64_t micro_steps = milli_mm * milli_steps_per_mm;
  const std::int64_t half = micro_steps < 0 ? -500'000 : 500'000;
  return static_cast<std::int32_t>((micro_steps + half) / 1'000'000);
}

/// Positions beyond this are refused even without soft limits: displacements stay in 32 bits.
inline constexpr std::int32_t max_position_steps = 1 << 29;

/// A, the only axis that can be rotary ($967).
inline constexpr int rotary_axis = 3;
/// Places of the axis are degrees, and it has no limit of travel.
constexpr bool is_rotary(const settings::Values& values, int axis) {
  return axis == rotary_axis && values.whole(settings::Id::rotary_axis) != 0;
}

/// The work space from the settings, or the maximum without soft limits and of a rotary axis; axes
/// that the machine lacks stay at 0.
constexpr StepLimits work_space(const settings::Values& values) {
  using settings::Id;
  StepLimits limits;
  for (int axis = 0; axis < values.whole(Id::axes); ++axis) {
    const std::int64_t corner = values.milli(Id::min_corner_x, axis);
    const std::int32_t steps_per_mm = values.milli(Id::steps_per_mm_x, axis);
    const auto i = static_cast<std::size_t>(axis);
    if (values.whole(Id::soft_limits) == 0 || is_rotary(values, axis)) {
      limits.min[i] = -max_position_steps;
      limits.max[i] = max_position_steps;
      continue;
    }
    limits.min[i] = steps_from_milli(corner, steps_per_mm);
    limits.max[i] = steps_from_milli(corner + values.milli(Id::travel_x, axis), steps_per_mm);
  }
  return limits;
}

}  // namespace lamplock
