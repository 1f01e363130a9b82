// Positive numbers with 32 significant bits and any exponent, for the line planner.
//
// In:  numbers that are positive or zero.
// Out: the same, rounded down by less than 2^-28 of themselves. A LinePacked is four bytes, for the
//      ring of lines; it is rounded down too, so that a stored limit is never above the limit.
// Who: the line planner (main loop, or the core that plans), some hundred times a line. Real
//      (path/real.hpp) is the same number; here numbers known to be normalised are not normalised
//      again, quotients and roots use divisions of 32 bits, and calls pass them in registers: a
//      product takes the Cortex-M0+ 40 cycles, a quotient 120, a root 120.
#pragma once

#include <concepts>
#include <cstdint>

namespace lamplock::motion {

namespace line_real {

/// Mantissa in the lower word, exponent in the upper: returned in two registers.
using Parts = std::uint64_t;
constexpr Parts parts(std::uint32_t mantissa, int exponent) {
  return std::uint64_t{static_cast<std::uint32_t>(exponent)} << 32 | mantissa;
}
/// Exponent of zero: lower than that of any number, so that comparing needs no special case.
inline constexpr int zero_exponent = -(1 << 24);
inline constexpr Parts zero = parts(0, zero_exponent);

/// From mantissas and the sum or difference of exponents.
[[gnu::const]] Parts product(std::uint32_t a, std::uint32_t b, int exponent);
[[gnu::const]] Parts quotient(std::uint32_t a, std::uint32_t b, int exponent);
/// From two numbers.
[[gnu::const]] Parts sum(std::uint32_t a, int a_exponent, std::uint32_t b, int b_exponent);
[[gnu::const]] Parts difference(std::uint32_t a, int a_exponent, std::uint32_t b, int b_exponent);
[[gnu::const]] Parts square_root(std::uint32_t a, int exponent);
/// From any number of 32 or 64 bits.
[[gnu::const]] Parts normalised(std::uint32_t value, int exponent);
[[gnu::const]] Parts normalised_64(std::uint64_t value, int exponent);

}  // namespace line_real

/// mantissa * 2^exponent; the mantissa is zero or has its highest bit set.
class UFloat {
 public:
  constexpr UFloat() = default;
  /// value * 2^exponent, rounded down.
  template <std::unsigned_integral Number>
  explicit UFloat(Number value, int exponent = 0)
      : UFloat(of(sizeof(Number) > sizeof(std::uint32_t)
                      ? line_real::normalised_64(value, exponent)
                      : line_real::normalised(static_cast<std::uint32_t>(value), exponent))) {}
  /// 2^exponent.
  static constexpr UFloat power(int exponent) {
    return UFloat::of_parts(std::uint32_t{1} << 31, exponent - 31);
  }
  /// The mantissa has its highest bit set.
  static constexpr UFloat of_parts(std::uint32_t mantissa, int exponent) {
    UFloat r;
    r.mantissa_ = mantissa;
    r.exponent_ = exponent;
    return r;
  }

  constexpr std::uint32_t mantissa() const { return mantissa_; }
  constexpr int exponent() const { return exponent_; }

  /// As fixed point with `bits` fractional bits, rounded down; at most 2^62.
  std::int64_t fixed(int bits) const;

  friend UFloat operator*(UFloat a, UFloat b) {
    return of(line_real::product(a.mantissa_, b.mantissa_, a.exponent_ + b.exponent_));
  }
  /// The divisor must not be zero.
  friend UFloat operator/(UFloat a, UFloat b) {
    return of(line_real::quotient(a.mantissa_, b.mantissa_, a.exponent_ - b.exponent_));
  }
  friend UFloat operator+(UFloat a, UFloat b) {
    return of(line_real::sum(a.mantissa_, a.exponent_, b.mantissa_, b.exponent_));
  }
  friend constexpr bool operator<(UFloat a, UFloat b) {
    return a.exponent_ != b.exponent_ ? a.exponent_ < b.exponent_ : a.mantissa_ < b.mantissa_;
  }
  /// a - b, or zero if that is negative; a if b is less than its last bit.
  friend UFloat difference(UFloat a, UFloat b) {
    return of(line_real::difference(a.mantissa_, a.exponent_, b.mantissa_, b.exponent_));
  }
  /// Rounded down, 28 significant bits or more.
  friend UFloat square_root(UFloat a) {
    return of(line_real::square_root(a.mantissa_, a.exponent_));
  }

 private:
  static constexpr UFloat of(line_real::Parts p) {
    return of_parts(static_cast<std::uint32_t>(p), static_cast<int>(p >> 32));
  }

  std::uint32_t mantissa_ = 0;
  int exponent_ = line_real::zero_exponent;
};

constexpr UFloat least(UFloat a, UFloat b) { return b < a ? b : a; }
constexpr UFloat most(UFloat a, UFloat b) { return a < b ? b : a; }
constexpr bool is_zero(UFloat a) { return a.mantissa() == 0; }

/// a 2^n, exact.
constexpr UFloat times_power(UFloat a, int n) {
  return is_zero(a) ? a : UFloat::of_parts(a.mantissa(), a.exponent() + n);
}

/// Whole number, rounded up; `most` if it is above that.
std::uint32_t whole_up(UFloat a, std::uint32_t most);
/// The same, rounded down.
std::uint32_t whole_down(UFloat a, std::uint32_t most);

/// A UFloat of 24 significant bits.
class LinePacked {
 public:
  LinePacked() = default;
  explicit LinePacked(UFloat value) {
    const int exponent = value.exponent() + exponent_bias;
    if (exponent < 0) return;
    const int kept = exponent > max_exponent ? max_exponent : exponent;
    // The highest bit is always set and makes room for the exponent.
    bits_ = static_cast<std::uint32_t>(kept) << (mantissa_bits - 1) |
            ((value.mantissa() << 1) >> (dropped_bits + 1));
  }

  UFloat real() const {
    if (bits_ == 0) return {};
    return UFloat::of_parts(bits_ << dropped_bits | std::uint32_t{1} << 31,
                            static_cast<int>(bits_ >> (mantissa_bits - 1)) - exponent_bias);
  }
  friend bool operator==(LinePacked, LinePacked) = default;
  friend bool operator<(LinePacked a, LinePacked b) { return a.bits_ < b.bits_; }

 private:
  /// The kept mantissa is the upper 24 bits, its highest bit included.
  static constexpr int dropped_bits = 8;
  static constexpr int mantissa_bits = 24;
  /// Added to the exponent: numbers from 2^-160 to 2^95.
  static constexpr int exponent_bias = 192;
  static constexpr int max_exponent = 255;

  std::uint32_t bits_ = 0;  ///< exponent above mantissa: bits compare as the numbers do
};

}  // namespace lamplock::motion
