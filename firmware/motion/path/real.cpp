#include "firmware/motion/path/real.hpp"

#include <bit>

#include "shared/fixed_point.hpp"

namespace lamplock::motion {

Real::Real(std::uint64_t value, int exponent) {
  if (value == 0) return;
  const int zeros = std::countl_zero(value);
  mantissa_ = static_cast<std::uint32_t>((value << zeros) >> 32);
  exponent_ = exponent + 32 - zeros;
}

Real Real::of_q32(std::int64_t value_q32) {
  return Real(value_q32 < 0 ? 0 : static_cast<std::uint64_t>(value_q32), -32);
}

std::int64_t Real::fixed(int bits) const {
  const int shift = exponent_ + bits;
  if (mantissa_ == 0 || shift <= -32) return 0;
  if (shift > 30) return std::int64_t{1} << 62;
  const std::int64_t m = mantissa_;
  return shift >= 0 ? m << shift : m >> -shift;
}

Real operator*(Real a, Real b) {
  return Real(wide_product(a.mantissa_, b.mantissa_), a.exponent_ + b.exponent_);
}

Real operator/(Real a, Real b) {
  // NOLINTNEXTLINE(clang-analyzer-core.DivideZero): the caller's duty
  return Real((std::uint64_t{a.mantissa_} << 32) / b.mantissa_, a.exponent_ - b.exponent_ - 32);
}

Real operator+(Real a, Real b) {
  if (a.mantissa_ == 0) return b;
  if (b.mantissa_ == 0) return a;
  const Real& large = a < b ? b : a;
  const Real& small = a < b ? a : b;
  const int apart = large.exponent_ - small.exponent_;
  const std::uint64_t low = apart >= 32 ? 0 : small.mantissa_ >> apart;
  return Real(large.mantissa_ + low, large.exponent_);
}

bool operator<(Real a, Real b) {
  if (a.mantissa_ == 0 || b.mantissa_ == 0) return a.mantissa_ < b.mantissa_;
  return a.exponent_ != b.exponent_ ? a.exponent_ < b.exponent_ : a.mantissa_ < b.mantissa_;
}

std::int64_t scaled(std::int64_t v, Real factor) {
  constexpr std::int64_t largest = std::int64_t{1} << 62;
  const Int128 product = Int128::product(v, factor.mantissa());
  const int shift = -factor.exponent();
  if (shift >= 128) return 0;
  if (shift < 0) return v == 0 ? 0 : largest;
  const Int128 result = product >> shift;
  return result > Int128(largest) ? largest : result.to_int64();
}

}  // namespace lamplock::motion
