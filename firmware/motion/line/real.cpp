#include "firmware/motion/line/real.hpp"

#include <bit>

#include "shared/fixed_point.hpp"

namespace lamplock::motion {
namespace line_real {
namespace {

constexpr std::uint32_t highest_bit = std::uint32_t{1} << 31;
constexpr std::uint32_t half_mask = 0xffffu;

/// One digit of 16 bits of a quotient: (rest 2^16 + digit) / divisor, rest < divisor, whose highest
/// bit is set; leaves the new rest. Estimated from the upper half of the divisor, at most two too
/// high (D. E. Knuth, "The Art of Computer Programming", vol. 2, 4.3.1, theorem B).
std::uint32_t quotient_digit(std::uint32_t& rest, std::uint32_t digit, std::uint32_t divisor) {
  const std::uint32_t upper = divisor >> 16, lower = divisor & half_mask;
  // NOLINTNEXTLINE(clang-analyzer-core.DivideZero): the highest bit is set
  std::uint32_t q = rest / upper;
  std::uint32_t r = rest - q * upper;
  while (q > half_mask || q * lower > (r << 16 | digit)) {
    --q;
    r += upper;
    if (r > half_mask) break;
  }
  rest = (rest << 16 | digit) - q * divisor;
  return q;
}

}  // namespace

Parts normalised(std::uint32_t value, int exponent) {
  if (value == 0) return zero;
  const int zeros = std::countl_zero(value);
  return parts(value << zeros, exponent - zeros);
}

Parts normalised_64(std::uint64_t value, int exponent) {
  const auto high = static_cast<std::uint32_t>(value >> 32),
             low = static_cast<std::uint32_t>(value);
  if (high == 0) return normalised(low, exponent);
  const int zeros = std::countl_zero(high);
  if (zeros == 0) return parts(high, exponent + 32);
  return parts(high << zeros | low >> (32 - zeros), exponent + 32 - zeros);
}

Parts product(std::uint32_t a, std::uint32_t b, int exponent) {
  const std::uint32_t a0 = a & half_mask, a1 = a >> 16, b0 = b & half_mask, b1 = b >> 16;
  const std::uint32_t mid1 = a1 * b0 + ((a0 * b0) >> 16);
  const std::uint32_t mid2 = a0 * b1 + (mid1 & half_mask);
  const std::uint32_t high = a1 * b1 + (mid1 >> 16) + (mid2 >> 16);
  if ((high & highest_bit) != 0) return parts(high, exponent + 32);
  if (high == 0) return zero;
  return parts(high << 1 | ((mid2 >> 15) & 1u), exponent + 31);
}

Parts quotient(std::uint32_t a, std::uint32_t b, int exponent) {
  if (a == 0) return zero;
  // The quotient has 32 bits, its highest one set.
  const bool large = a >= b;
  std::uint32_t rest = large ? a >> 1 : a;
  const std::uint32_t next = large ? (a & 1u) << 15 : 0;
  const std::uint32_t high = quotient_digit(rest, next, b);
  const std::uint32_t low = quotient_digit(rest, 0, b);
  return parts(high << 16 | low, exponent - (large ? 31 : 32));
}

Parts sum(std::uint32_t a, int a_exponent, std::uint32_t b, int b_exponent) {
  int apart = a_exponent - b_exponent;
  if (apart < 0) {
    const std::uint32_t m = a;
    a = b;
    b = m;
    a_exponent = b_exponent;
    apart = -apart;
  }
  const std::uint32_t all = a + (apart >= 32 ? 0 : b >> apart);
  if (all >= a) return parts(all, a_exponent);
  return parts(all >> 1 | highest_bit, a_exponent + 1);
}

Parts difference(std::uint32_t a, int a_exponent, std::uint32_t b, int b_exponent) {
  const int apart = a_exponent - b_exponent;
  if (apart < 0 || (apart == 0 && a <= b)) return zero;
  if (apart >= 32) return parts(a, a_exponent);
  if (apart == 0) return normalised(a - b, a_exponent);
  // Keeps the bits of the smaller one that are shifted out: the difference may be much smaller.
  const std::uint32_t out = b << (32 - apart);
  const std::uint32_t left = a - (b >> apart) - (out != 0 ? 1 : 0);
  if ((left & highest_bit) != 0) return parts(left, a_exponent);
  return normalised_64(std::uint64_t{left} << 32 | (0 - out), a_exponent - 32);
}

Parts square_root(std::uint32_t a, int exponent) {
  if (a == 0) return zero;
  // n 2^2k with n of 29 or 30 bits.
  const int shift = 2 + (exponent & 1);
  // Root of n 2^32, 31 bits; up to 2 too high.
  const std::uint32_t root = root_of_upper_half(a >> shift) - 2;
  const int root_exponent = (exponent + shift - 32) / 2;
  if ((root & highest_bit >> 1) == 0) return normalised(root, root_exponent);
  return parts(root << 1, root_exponent - 1);
}

}  // namespace line_real

std::int64_t UFloat::fixed(int bits) const {
  const int shift = exponent_ + bits;
  if (shift <= -32) return 0;
  if (shift > 30) return std::int64_t{1} << 62;
  if (shift <= 0) return std::int64_t{mantissa_ >> -shift};
  return static_cast<std::int64_t>(std::uint64_t{mantissa_ >> (32 - shift)} << 32 | mantissa_
                                                                                        << shift);
}

std::uint32_t whole_down(UFloat a, std::uint32_t most) {
  const int shift = -a.exponent();
  if (shift >= 32) return 0;
  if (shift < 0) return most;
  const std::uint32_t n = a.mantissa() >> shift;
  return n > most ? most : n;
}

std::uint32_t whole_up(UFloat a, std::uint32_t most) {
  const int shift = -a.exponent();
  if (shift <= 0) return whole_down(a, most);
  if (shift >= 32) return is_zero(a) || most == 0 ? 0 : 1;
  const std::uint32_t n = (a.mantissa() >> shift) + (a.mantissa() << (32 - shift) != 0 ? 1 : 0);
  return n > most ? most : n;
}

}  // namespace lamplock::motion
