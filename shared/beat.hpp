// The beat in ticks, from the settings: one rule for planner, beat clock and host.
#pragma once

#include <cstdint>

#include "shared/settings_table.hpp"
#include "shared/units.hpp"

namespace lamplock {

/// Shrinking of the tick that limits must allow for, Q16: 65536 = none.
inline constexpr std::uint32_t full_tick_q16 = 65536;

/// Ticks in a beat of the nominal lamp frequency, rounded.
constexpr std::uint32_t beat_ticks(const settings::Values& values) {
  const auto milli_hz = static_cast<std::uint64_t>(values.milli(settings::Id::lamp_frequency));
  constexpr std::uint64_t milli_ticks = std::uint64_t{ticks_per_second} * 1000;
  return static_cast<std::uint32_t>((milli_ticks + milli_hz / 2) / milli_hz);
}

}  // namespace lamplock
