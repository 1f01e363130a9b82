// Simulated time.
#pragma once

#include <cstdint>
#include <limits>

namespace lamplock::sim {

/// Simulated time since power-up.
using Picoseconds = std::int64_t;
/// "No event": later than everything.
inline constexpr Picoseconds never = std::numeric_limits<Picoseconds>::max();
inline constexpr Picoseconds ps_per_ns = 1'000;
inline constexpr Picoseconds ps_per_us = 1'000'000;
inline constexpr Picoseconds ps_per_ms = 1'000'000'000;
inline constexpr Picoseconds ps_per_s = 1'000'000'000'000;
constexpr double seconds(Picoseconds time) {
  return static_cast<double>(time) / static_cast<double>(ps_per_s);
}

}  // namespace lamplock::sim
