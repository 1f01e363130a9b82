// Arithmetic of the beat clock: differences of times in clocks and shares of them.
//
// In:  times in clocks, Q16; lengths of a tick in clocks, Q32; shares, Q16 or Q32.
// Out: the same.
// Who: beat_clock*.cpp alone. Budget: no division; no product of more than 32 bits by 32 bits.
#pragma once

#include <cstdint>

#include "shared/fixed_point.hpp"
#include "shared/units.hpp"

namespace lamplock::lamp {

inline constexpr std::int64_t nominal_tick_q32 = std::int64_t{clocks_per_tick} << 32;
/// Beats without an edge after which the lock is lost.
inline constexpr std::uint32_t missed_to_loss = 32;

/// Signed difference of two times that may have wrapped.
inline std::int64_t difference(std::uint64_t later_q16, std::uint64_t earlier_q16) {
  return static_cast<std::int64_t>(later_q16 - earlier_q16);
}

inline std::int64_t clamped(std::int64_t x, std::int64_t low, std::int64_t high) {
  return x < low ? low : x > high ? high : x;
}

/// x * f / 2^32, rounded down, for x >= 0.
[[gnu::noinline]] inline std::int64_t share_q32(std::int64_t x, std::uint32_t f) {
  const auto high = static_cast<std::uint32_t>(x >> 32);
  const std::uint64_t low = wide_product(static_cast<std::uint32_t>(x), f) >> 32;
  return static_cast<std::int64_t>(high == 0 ? low : low + wide_product(high, f));
}

}  // namespace lamplock::lamp
