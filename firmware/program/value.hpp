// Programmed values: exact decimals.
//
// All values of a program are stored in whole multiples of 10^-7 of their unit ("e7": mm, degree,
// second, rev/min). Seven decimals of a millimetre and six of an inch are exact, so absolute and
// relative programs end at the same place however long they are. Steps are rounded once, by the
// machine.
#pragma once

#include <cstdint>

#include "shared/units.hpp"

namespace lamplock::program {

inline constexpr std::int64_t one_e7 = 10'000'000;
/// An inch, by its definition of 25.4 mm.
inline constexpr std::int64_t inch_e7 = 254'000'000;
/// Positions are within +-10 m: squares of distances fit twice into 128 bits.
inline constexpr std::int64_t max_position_e7 = 10'000 * one_e7;

/// A position or a distance of all axes, X Y Z A, 10^-7 mm.
using Place = PerAxis<std::int64_t>;

/// Whether two places are the same, without a call of memcmp.
constexpr bool same_place(const Place& a, const Place& b) {
  return a[0] == b[0] && a[1] == b[1] && a[2] == b[2] && a[3] == b[3];
}

}  // namespace lamplock::program
