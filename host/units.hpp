// Settings in their units, and factors between common units and those of the settings.
#pragma once

#include "shared/settings_table.hpp"

namespace lamplock {

/// Settings are stored in thousandths of their unit.
inline constexpr double milli_per_unit = 1000.0;
inline constexpr double mm_s2_per_m_s2 = 1000.0;
inline constexpr double mm_min_per_m_s = 60'000.0;
inline constexpr double mm_per_inch = 25.4;

/// A setting in its unit.
inline double in_units(const settings::Values& values, settings::Id id) {
  return values.milli(id) / milli_per_unit;
}
inline double in_units(const settings::Values& values, settings::Id x_row, int axis) {
  return in_units(values, settings::for_axis(x_row, axis));
}

}  // namespace lamplock
