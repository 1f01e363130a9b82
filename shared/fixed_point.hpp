// Fixed-point helpers of the firmware: products, quotients and roots with documented rounding.
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
/// Middle of a step in a Q64 fraction: the position of every axis at an integer point.
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

namespace detail {
/// Root of a number of 63 or 64 bits, rounded down and up to 3 more (measured). Eight bits from a
/// table, doubled twice by Newton's iteration.
constexpr std::uint32_t near_root_of_normalised(std::uint64_t n) {
  const auto high = static_cast<std::uint32_t>(n >> 32), low = static_cast<std::uint32_t>(n);
  const std::uint32_t r8 = std::uint32_t{root_table[(high >> 24) - 64]} << 8;
  const std::uint32_t r16 = (r8 + high / r8) / 2;  // at most 2^16
  // n / (r16 2^16) in two steps of 32 bits.
  const std::uint32_t q1 = high / r16, rest = high % r16;
  const std::uint32_t q0 = (rest << 16 | low >> 16) / r16;
  const std::uint64_t r32 = ((std::uint64_t{r16} << 16) + (std::uint64_t{q1} << 16) + q0) / 2;
  return r32 > 0xffffffffu ? 0xffffffffu : static_cast<std::uint32_t>(r32);
}

/// The same, rounded down.
constexpr std::uint32_t root_of_normalised(std::uint64_t n) {
  std::uint32_t r = near_root_of_normalised(n);
  auto excess = static_cast<std::int64_t>(wide_product(r, r) - n);
  while (excess > 0) {  // (r - 1)^2 = r^2 - (2 r - 1)
    excess -= 2 * std::int64_t{r} - 1;
    --r;
  }
  return r;
}
}  // namespace detail

/// Largest r with r * r <= x.
constexpr std::uint32_t isqrt(std::uint64_t x) {
  if (x == 0) return 0;
  const int shift = std::countl_zero(x) & ~1;
  return detail::root_of_normalised(x << shift) >> (shift / 2);
}

/// At most the root of x and at most one less than isqrt(); faster.
constexpr std::uint32_t nearly_isqrt(std::uint64_t x) {
  if (x == 0) return 0;
  const int shift = std::countl_zero(x) & ~1;
  return (detail::near_root_of_normalised(x << shift) - 3) >> (shift / 2);
}

/// Root of n 2^32 for 2^28 <= n < 2^30, which has 31 bits: rounded down and up to 2 more
/// (all tried).
constexpr std::uint32_t root_of_upper_half(std::uint32_t n) {
  const std::uint32_t r8 = std::uint32_t{detail::root_table[(n >> 22) - 64]} << 7;
  const std::uint32_t r15 = (r8 + n / r8) / 2;
  const std::uint32_t q1 = n / r15, rest = n % r15;
  return ((r15 + q1) << 15) + ((rest << 16) / r15 >> 1);
}

/// Root of a Q32 number, rounded down, 31 significant bits; 0 for x <= 0.
constexpr std::int64_t sqrt_down_q32(std::int64_t x_q32) {
  if (x_q32 <= 0) return 0;
  const auto x = static_cast<std::uint64_t>(x_q32);
  const int shift = std::countl_zero(x) & ~1;
  const std::int64_t root = detail::root_of_normalised(x << shift);
  const int back = 16 - shift / 2;  // sqrt(x 2^32) 2^16, undoing half of the shift
  return back >= 0 ? root << back : root >> -back;
}

/// Product with a number below 2^16, modulo 2^64, from three short products.
constexpr std::int64_t portable_times_short(std::int64_t x, std::uint32_t n) {
  const auto low = static_cast<std::uint32_t>(x);
  const std::uint32_t p0 = (low & 0xffffu) * n;
  const std::uint32_t p1 = (low >> 16) * n + (p0 >> 16);
  const std::uint32_t high = static_cast<std::uint32_t>(x >> 32) * n + (p1 >> 16);
  return static_cast<std::int64_t>(std::uint64_t{high} << 32 | (p1 << 16 | (p0 & 0xffffu)));
}

/// The same, faster.
constexpr std::int64_t times_short(std::int64_t x, std::uint32_t n) {
#ifdef __SIZEOF_INT128__
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(x) * n);
#else
  return portable_times_short(x, n);
#endif
}

constexpr std::int64_t abs64(std::int64_t x) { return x < 0 ? -x : x; }

}  // namespace lamplock
