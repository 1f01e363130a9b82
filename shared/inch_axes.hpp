// Axes whose places the board reports in inches: one rule for the firmware that writes reports and
// the host that reads them.
#pragma once

#include <cstdint>

#include "shared/settings_table.hpp"
#include "shared/work_space.hpp"

namespace lamplock {

/// A bit for each axis; none: reports are in mm.
struct InchAxes {
  std::uint8_t bits = 0;

  constexpr bool any() const { return bits != 0; }
  constexpr bool has(int axis) const { return (bits >> axis & 1u) != 0; }
};

/// With $13=1 all axes but a rotary one ($967), whose places are degrees.
constexpr InchAxes inch_axes(const settings::Values& values) {
  using settings::Id;
  if (values.whole(Id::report_inches) == 0) return {};
  constexpr std::uint8_t all = (1u << max_axes) - 1, linear = all & ~(1u << rotary_axis);
  return {is_rotary(values, rotary_axis) ? linear : all};
}

}  // namespace lamplock
