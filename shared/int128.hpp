// A signed 128-bit integer with the operations that planner and stepper need.
//
// The Cortex-M0+ has no 128-bit type, and both boards must give identical results, so the same code
// runs everywhere. Positions are Q64 (steps with a 64-bit fraction), speeds and accelerations Q62;
// their products with tick counts need the width.
#pragma once

#include <compare>
#include <cstdint>

namespace lamplock {

/// Exact product of two 32-bit numbers from four products of halves: for machines that only
/// multiply 32 by 32 bits to 32 and would call a function for more.
constexpr std::uint64_t portable_wide_product(std::uint32_t a, std::uint32_t b) {
  const std::uint32_t a0 = a & 0xffffu, a1 = a >> 16, b0 = b & 0xffffu, b1 = b >> 16;
  const std::uint32_t low = a0 * b0;
  const std::uint32_t mid1 = a1 * b0 + (low >> 16);
  const std::uint32_t mid2 = a0 * b1 + (mid1 & 0xffffu);
  const std::uint32_t high = a1 * b1 + (mid1 >> 16) + (mid2 >> 16);
  return std::uint64_t{high} << 32 | (mid2 << 16 | (low & 0xffffu));
}

/// Exact product of two 32-bit numbers, faster.
constexpr std::uint64_t wide_product(std::uint32_t a, std::uint32_t b) {
#ifdef __SIZEOF_INT128__
  return std::uint64_t{a} * b;
#else
  return portable_wide_product(a, b);
#endif
}

/// a n for n below 2^16, modulo 2^64: three products of 32 bits, where a general product calls a
/// function.
constexpr std::int64_t short_product(std::int64_t a, std::uint32_t n) {
  const auto low = static_cast<std::uint32_t>(a), high = static_cast<std::uint32_t>(a >> 32);
  const std::uint32_t low0 = (low & 0xffffu) * n, low1 = (low >> 16) * n;
  const std::uint64_t product = (std::uint64_t{low1} << 16) + low0;
  return static_cast<std::int64_t>(product + (std::uint64_t{high * n} << 32));
}

/// Two's complement, wraps like the built-in unsigned types.
class Int128 {
 public:
  constexpr Int128() = default;
  constexpr Int128(std::int64_t value)  // NOLINT: an integer is an integer
      : hi_(value < 0 ? ~std::uint64_t{0} : 0), lo_(static_cast<std::uint64_t>(value)) {}
  constexpr Int128(std::uint64_t hi, std::uint64_t lo) : hi_(hi), lo_(lo) {}

  constexpr std::uint64_t lo() const { return lo_; }
  constexpr std::int64_t hi() const { return static_cast<std::int64_t>(hi_); }
  constexpr bool negative() const { return (hi_ >> 63) != 0; }

  /// Exact product of two 64-bit numbers.
  static constexpr Int128 product(std::int64_t a, std::int64_t b) {
    const Int128 p = unsigned_product(magnitude(a), magnitude(b));
    if ((a < 0) == (b < 0)) return p;
    const std::uint64_t lo = 0 - p.lo_;
    return {~p.hi_ + (lo == 0 ? 1u : 0u), lo};
  }

  /// a n for n below 2^16, exact: four products of 32 bits.
  static constexpr Int128 short_product(std::int64_t a, std::uint32_t n) {
    const auto low = static_cast<std::uint32_t>(a), high = static_cast<std::uint32_t>(a >> 32);
    const std::uint64_t p0 = (std::uint64_t{(low >> 16) * n} << 16) + (low & 0xffffu) * n;
    const std::uint64_t p1 =
        (std::uint64_t{(high >> 16) * n} << 16) + (high & 0xffffu) * n + (p0 >> 32);
    // A negative number adds 2^64 n too much.
    const std::uint64_t top = (p1 >> 32) - (a < 0 ? n : 0);
    return {top, p1 << 32 | static_cast<std::uint32_t>(p0)};
  }

  /// a n, exact; fast for n below 2^16, as ticks of a way usually are.
  static constexpr Int128 times(std::int64_t a, std::uint32_t n) {
    return n >> 16 == 0 ? short_product(a, n) : product(a, n);
  }

  friend constexpr Int128 operator+(Int128 a, Int128 b) {
    const std::uint64_t lo = a.lo_ + b.lo_;
    return {a.hi_ + b.hi_ + (lo < a.lo_ ? 1u : 0u), lo};
  }
  friend constexpr Int128 operator-(Int128 a, Int128 b) {
    return {a.hi_ - b.hi_ - (a.lo_ < b.lo_ ? 1u : 0u), a.lo_ - b.lo_};
  }
  constexpr Int128 operator-() const { return Int128{} - *this; }
  constexpr Int128 operator~() const { return {~hi_, ~lo_}; }

  /// Shifts by 0..127; the right shift is arithmetic (towards minus infinity).
  friend constexpr Int128 operator<<(Int128 a, int n) {
    if (n == 0) return a;
    if (n >= 64) return {a.lo_ << (n - 64), 0};
    return {(a.hi_ << n) | (a.lo_ >> (64 - n)), a.lo_ << n};
  }
  friend constexpr Int128 operator>>(Int128 a, int n) {
    if (n == 0) return a;
    if (n >= 64) {
      const std::int64_t hi = a.hi() >> (n - 64);
      return {hi < 0 ? ~std::uint64_t{0} : 0, static_cast<std::uint64_t>(hi)};
    }
    return {static_cast<std::uint64_t>(a.hi() >> n), (a.lo_ >> n) | (a.hi_ << (64 - n))};
  }

  friend constexpr bool operator==(const Int128&, const Int128&) = default;
  friend constexpr std::strong_ordering operator<=>(const Int128& a, const Int128& b) {
    if (a.hi() != b.hi()) return a.hi() <=> b.hi();
    return a.lo_ <=> b.lo_;
  }

  /// Quotient by a positive 32-bit number, rounded towards minus infinity.
  constexpr Int128 divided_by(std::uint32_t divisor) const {
    if (!negative()) return unsigned_quotient(*this, divisor);
    return ~unsigned_quotient(~*this, divisor);  // floor(x / d) = -floor((-x - 1) / d) - 1
  }

  /// Product of two unsigned numbers from 32-bit pieces, for machines without a wide multiplier.
  static constexpr Int128 portable_product(std::uint64_t a, std::uint64_t b) {
    const auto a0 = static_cast<std::uint32_t>(a), a1 = static_cast<std::uint32_t>(a >> 32);
    const auto b0 = static_cast<std::uint32_t>(b), b1 = static_cast<std::uint32_t>(b >> 32);
    const std::uint64_t low = portable_wide_product(a0, b0);
    const std::uint64_t mid1 = portable_wide_product(a1, b0) + (low >> 32);
    const std::uint64_t low32 = low & 0xffffffffu;
    if (b1 == 0) return {mid1 >> 32, (mid1 << 32) | low32};  // often: a number of ticks
    const std::uint64_t mid2 = portable_wide_product(a0, b1) + (mid1 & 0xffffffffu);
    return {portable_wide_product(a1, b1) + (mid1 >> 32) + (mid2 >> 32), (mid2 << 32) | low32};
  }

  /// The value as 64-bit integer; it must fit.
  constexpr std::int64_t to_int64() const { return static_cast<std::int64_t>(lo_); }

 private:
  static constexpr std::uint64_t magnitude(std::int64_t v) {
    return v < 0 ? 0 - static_cast<std::uint64_t>(v) : static_cast<std::uint64_t>(v);
  }
#ifdef __SIZEOF_INT128__
  // Machines with a 64 x 64 multiplier: the same numbers, several times faster.
  __extension__ using Native = unsigned __int128;
  static constexpr Int128 unsigned_product(std::uint64_t a, std::uint64_t b) {
    const Native p = Native{a} * b;
    return {static_cast<std::uint64_t>(p >> 64), static_cast<std::uint64_t>(p)};
  }
#else
  static constexpr Int128 unsigned_product(std::uint64_t a, std::uint64_t b) {
    return portable_product(a, b);
  }
#endif
  static constexpr Int128 unsigned_quotient(Int128 a, std::uint32_t d) {
    std::uint64_t hi = 0, rest = a.hi_;
    if (rest == 0) return {0, a.lo_ / d};
    if (rest >= d) {
      hi = rest / d;
      rest %= d;
    }
    rest = (rest << 32) | (a.lo_ >> 32);
    const std::uint64_t mid = rest / d;
    rest = ((rest % d) << 32) | (a.lo_ & 0xffffffffu);
    return {hi, (mid << 32) + rest / d};
  }

  std::uint64_t hi_ = 0;
  std::uint64_t lo_ = 0;
};

}  // namespace lamplock
