#include "firmware/motion/line_real.hpp"

#include "shared/fixed_point.hpp"

namespace lamplock::motion {
namespace {

/// The kept mantissa is the upper 24 bits, its highest bit included.
constexpr int dropped_bits = 8;
constexpr int mantissa_bits = 24;
/// Added to the exponent: numbers from 2^-160 to 2^95.
constexpr int exponent_bias = 192;
constexpr int largest_exponent = 255;

}  // namespace

Real difference(Real a, Real b) {
  if (is_zero(b)) return a;
  if (!(b < a)) return {};
  const int apart = a.exponent() - b.exponent();
  if (apart >= 32) return a;
  // Two more bits of the smaller one, for what is left may be much smaller.
  const std::uint64_t large = std::uint64_t{a.mantissa()} << 31;
  const std::uint64_t small = (std::uint64_t{b.mantissa()} << 31) >> apart;
  return Real(large - small, a.exponent() - 31);
}

Real square_root(Real a) {
  if (is_zero(a)) return {};
  const int odd = a.exponent() & 1;
  // 2^31 (m 2^odd), its root has 31 or 32 bits; the exponent left is even.
  const std::uint64_t m = std::uint64_t{a.mantissa()} << (30 + odd);
  return Real(isqrt(m), (a.exponent() - odd - 30) / 2);
}

std::uint32_t whole_down(Real a, std::uint32_t most) {
  const std::int64_t n = a.fixed(0);
  return n > static_cast<std::int64_t>(most) ? most : static_cast<std::uint32_t>(n);
}

std::uint32_t whole_up(Real a, std::uint32_t most) {
  const std::uint32_t n = whole_down(a, most);
  return n < most && Real(n) < a ? n + 1 : n;
}

LinePacked::LinePacked(Real value) {
  const int exponent = value.exponent() + exponent_bias;
  if (is_zero(value) || exponent < 0) return;
  const int kept = exponent > largest_exponent ? largest_exponent : exponent;
  // The highest bit is always set and makes room for the exponent.
  bits_ = static_cast<std::uint32_t>(kept) << (mantissa_bits - 1) |
          ((value.mantissa() >> dropped_bits) & ((1u << (mantissa_bits - 1)) - 1));
}

Real LinePacked::real() const {
  if (bits_ == 0) return {};
  const std::uint32_t low = bits_ & ((1u << (mantissa_bits - 1)) - 1);
  const auto exponent = static_cast<int>(bits_ >> (mantissa_bits - 1)) - exponent_bias;
  return Real((low | 1u << (mantissa_bits - 1)), exponent + dropped_bits);
}

}  // namespace lamplock::motion
