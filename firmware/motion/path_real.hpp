// Positive numbers with 32 significant bits and any exponent, from integer instructions alone.
//
// The geometry of a path multiplies and divides lengths, directions and limits of very different
// size; a common fixed point would overflow or lose what is small. Every result is rounded down, by
// less than 2^-31 of itself.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>

#include "shared/fixed_point.hpp"

namespace lamplock::motion {

/// mantissa * 2^exponent; the mantissa is zero or has its highest bit set.
class Real {
 public:
  constexpr Real() = default;
  /// value * 2^exponent, rounded down.
  constexpr explicit Real(std::uint64_t value, int exponent = 0) {
    if (value == 0) return;
    const int zeros = std::countl_zero(value);
    mantissa_ = static_cast<std::uint32_t>((value << zeros) >> 32);
    exponent_ = exponent + 32 - zeros;
  }
  /// A Q32 number; 0 for a negative one.
  static constexpr Real of_q32(std::int64_t value_q32) {
    return Real(value_q32 < 0 ? 0 : static_cast<std::uint64_t>(value_q32), -32);
  }

  constexpr std::uint32_t mantissa() const { return mantissa_; }
  constexpr int exponent() const { return exponent_; }
  constexpr bool zero() const { return mantissa_ == 0; }

  /// The number as fixed point with `bits` fractional bits, rounded down; what does not fit into 62
  /// bits is returned as 2^62.
  constexpr std::int64_t fixed(int bits) const {
    const int shift = exponent_ + bits;
    if (mantissa_ == 0 || shift <= -32) return 0;
    if (shift > 30) return std::int64_t{1} << 62;
    const std::int64_t m = mantissa_;
    return shift >= 0 ? m << shift : m >> -shift;
  }

  friend constexpr Real operator*(Real a, Real b) {
    return Real(wide_product(a.mantissa_, b.mantissa_), a.exponent_ + b.exponent_);
  }
  /// The divisor must not be zero.
  friend constexpr Real operator/(Real a, Real b) {
    return Real((std::uint64_t{a.mantissa_} << 32) / b.mantissa_, a.exponent_ - b.exponent_ - 32);
  }
  friend constexpr Real operator+(Real a, Real b) {
    if (a.mantissa_ == 0) return b;
    if (b.mantissa_ == 0) return a;
    if (a.exponent_ < b.exponent_) return b + a;
    const int apart = a.exponent_ - b.exponent_;
    const std::uint64_t low = apart >= 32 ? 0 : b.mantissa_ >> apart;
    return Real(a.mantissa_ + low, a.exponent_);
  }
  friend constexpr bool operator<(Real a, Real b) {
    if (a.mantissa_ == 0 || b.mantissa_ == 0) return a.mantissa_ < b.mantissa_;
    return a.exponent_ != b.exponent_ ? a.exponent_ < b.exponent_ : a.mantissa_ < b.mantissa_;
  }

 private:
  std::uint32_t mantissa_ = 0;
  int exponent_ = 0;
};

}  // namespace lamplock::motion
