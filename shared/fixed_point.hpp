// Fixed-point helpers of the firmware: products, quotients and roots that say how they round.
//
// The Q format is part of every name: speed_q62 is a speed with 62 fractional bits. Planner
// intervals are rounded inwards.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "shared/int128.hpp"

namespace lamplock {

inline constexpr std::int64_t one_q32 = std::int64_t{1} << 32;
inline constexpr std::int64_t one_q62 = std::int64_t{1} << 62;
/// Middle of a step in a Q64 fraction: where every axis stands at an integer point.
inline constexpr std::uint64_t half_step_q64 = std::uint64_t{1} << 63;

/// Product of two Q32 numbers, rounded down.
constexpr std::int64_t mul_q32(std::int64_t a, std::int64_t b) {
  return (Int128::product(a, b) >> 32).to_int64();
}

/// a * b / c rounded down; c > 0, the result must fit.
constexpr std::int64_t mul_div(std::int64_t a, std::int64_t b, std::uint32_t c) {
  return Int128::product(a, b).divided_by(c).to_int64();
}

namespace detail {
/// Roots of 64..255 in units of 1/16, from the middle of each interval: 8 bits of a root.
inline constexpr std::array<std::uint8_t, 192> root_table = [] {
  std::array<std::uint8_t, 192> table{};
  for (std::uint32_t i = 0; i < 192; ++i) {
    const std::uint32_t middle = (64 + i) * 256 + 128;
    std::uint32_t r = 128;
    while (r < 255 && (r + 1) * (r + 1) <= middle) ++r;
    table[i] = static_cast<std::uint8_t>(r);
  }
  return table;
}();
}  // namespace detail

/// Largest r with r * r <= x. Eight bits from a table, doubled twice by Newton's iteration.
constexpr std::uint32_t isqrt(std::uint64_t x) {
  if (x == 0) return 0;
  const int shift = std::countl_zero(x) & ~1;
  const std::uint64_t n = x << shift;
  const std::uint32_t r8 = std::uint32_t{detail::root_table[static_cast<std::size_t>(n >> 56) - 64]}
                           << 8;
  const std::uint32_t r16 = (r8 + static_cast<std::uint32_t>(n >> 32) / r8) / 2;
  const std::uint64_t r32 = std::uint64_t{r16} << 16;
  std::uint64_t r = (r32 + n / r32) / 2;
  if (r > 0xffffffffu) r = 0xffffffffu;
  while (r * r > n) --r;
  while (r < 0xffffffffu && (r + 1) * (r + 1) <= n) ++r;
  return static_cast<std::uint32_t>(r >> (shift / 2));
}

/// Root of a Q32 number, rounded down, 31 significant bits; 0 for x <= 0.
constexpr std::int64_t sqrt_down_q32(std::int64_t x_q32) {
  if (x_q32 <= 0) return 0;
  const auto x = static_cast<std::uint64_t>(x_q32);
  const int shift = std::countl_zero(x) & ~1;
  const std::int64_t root = isqrt(x << shift);
  const int back = 16 - shift / 2;  // sqrt(x 2^32) 2^16, undoing half of the shift
  return back >= 0 ? root << back : root >> -back;
}

constexpr std::int64_t abs64(std::int64_t x) { return x < 0 ? -x : x; }

}  // namespace lamplock
