// Positive numbers with 32 significant bits and any exponent, using only integer instructions.
//
// The geometry of a path multiplies and divides lengths, directions and limits of very different
// size; a common fixed point would overflow or lose small values. Every result is rounded down, by
// less than 2^-31 of itself.
#pragma once

#include <cstdint>

namespace lamplock::motion {

/// mantissa * 2^exponent; the mantissa is zero or has its highest bit set.
class Real {
 public:
  constexpr Real() = default;
  /// value * 2^exponent, rounded down.
  explicit Real(std::uint64_t value, int exponent = 0);
  /// A Q32 number; 0 for a negative one.
  static Real of_q32(std::int64_t value_q32);

  std::uint32_t mantissa() const { return mantissa_; }
  int exponent() const { return exponent_; }

  /// The number as fixed point with `bits` fractional bits, rounded down; at most 2^62.
  std::int64_t fixed(int bits) const;

  friend Real operator*(Real a, Real b);
  /// The divisor must not be zero.
  friend Real operator/(Real a, Real b);
  friend Real operator+(Real a, Real b);
  friend bool operator<(Real a, Real b);

 private:
  std::uint32_t mantissa_ = 0;
  int exponent_ = 0;
};

/// v * factor for v >= 0, rounded down; at most 2^62.
std::int64_t scaled(std::int64_t v, Real factor);

}  // namespace lamplock::motion
