// Converts the setting of the delay to the clocks that the fire stage counts.
//
// In:  $902 in thousandths of a microsecond. Out: clocks from the clock at which the board detects
//      the rising edge of LAMP SYNC to the one at which the Q-switch rises.
// Who: controller, beat clock; whenever settings change.
//
// $902 is an upper bound, measured at the pins: a laser that must be fired within 20 us is fired
// within 20.000 us. So clocks are rounded down, and two are subtracted, or three at 200 MHz:
//
//   LAMP SYNC  __/~~~~~~~~~~~~~      rises anywhere between two clocks
//   clock      |   |   |   |   |     detected at the next one: up to one clock later
//   Q-SWITCH   _______________/~     both pads delay by some ns, the crystal is off by some 10 ppm:
//                                    less than another 8 ns
#pragma once

#include <cstdint>

#include "shared/units.hpp"

namespace lamplock::lamp {

inline constexpr std::uint32_t sampling_clocks = 1;
inline constexpr std::uint32_t pad_margin_ns = 8;
inline constexpr std::uint32_t pad_margin_clocks = (pad_margin_ns * clocks_per_us + 999) / 1000;

/// `milli_us` is at most 1000 us.
constexpr std::uint32_t shot_delay_clocks(std::int32_t milli_us) {
  return static_cast<std::uint32_t>(milli_us) * clocks_per_us / 1000 - sampling_clocks -
         pad_margin_clocks;
}

}  // namespace lamplock::lamp
