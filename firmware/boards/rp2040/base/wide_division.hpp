// Division of 64-bit numbers, made of divisions of 32-bit ones.
//
// In:  dividend and divisor (not zero), unsigned; a divider for 32 bits.
// Out: quotient and remainder, exact.
// Who: arithmetic.cpp with the divider of the RP2040; tests with that of a PC.
//
// Short divisors take three steps of 16 bits, longer ones the schoolbook method with digits of 16
// bits: D. E. Knuth, "The Art of Computer Programming", vol. 2, 4.3.1, algorithm D. The 64-bit
// divisor needs one estimate from its upper 32 bits, at most one too large.
#pragma once

#include <cstdint>

namespace lamplock::rp2040 {

struct Division {
  std::uint32_t quotient = 0;
  std::uint32_t rest = 0;
};

/// `Divider::divide(n, d)` gives a Division.
template <class Divider>
class WideDivision {
 public:
  /// Quotient; leaves the remainder in `rest`.
  [[gnu::always_inline]] static std::uint64_t divide(std::uint64_t n, std::uint64_t d,
                                                     std::uint64_t& rest) {
    const std::uint32_t n1 = upper(n), n0 = lower(n), d0 = lower(d);
    if (upper(d) != 0) return by_64_bits(n, d, rest);
    Division high{0, n1};
    if (n1 >= d0) high = Divider::divide(n1, d0);
    const Division low = high.rest == 0 ? Divider::divide(n0, d0)
                         : d0 <= 0xffff ? by_16_bits(high.rest, n0, d0)
                                        : by_32_bits(high.rest, n0, d0);
    rest = low.rest;
    return std::uint64_t{high.quotient} << 32 | low.quotient;
  }

 private:
  static std::uint32_t upper(std::uint64_t x) { return static_cast<std::uint32_t>(x >> 32); }
  static std::uint32_t lower(std::uint64_t x) { return static_cast<std::uint32_t>(x); }

  /// (n1, n0) / d with n1 < d < 2^16.
  static Division by_16_bits(std::uint32_t n1, std::uint32_t n0, std::uint32_t d) {
    const Division a = Divider::divide(n1 << 16 | n0 >> 16, d);
    const Division b = Divider::divide(a.rest << 16 | (n0 & 0xffff), d);
    return {a.quotient << 16 | b.quotient, b.rest};
  }

  /// A digit of (rest, next) / d: rest < d, d normalised, next < 2^16. Leaves the new rest.
  static std::uint32_t digit(std::uint32_t& rest, std::uint32_t next, std::uint32_t d) {
    const std::uint32_t d1 = d >> 16, d0 = d & 0xffff;
    const Division guess = Divider::divide(rest, d1);
    std::uint32_t q = guess.quotient, r = guess.rest;
    // At most two too large; if r exceeds 16 bits the guess is right.
    while (r <= 0xffff && (q > 0xffff || q * d0 > (r << 16 | next))) {
      --q;
      r += d1;
    }
    rest = (rest << 16 | next) - q * d;
    return q;
  }

  /// (n1, n0) / d with n1 < d and the uppermost bit of d set.
  static Division by_normalised(std::uint32_t n1, std::uint32_t n0, std::uint32_t d) {
    const std::uint32_t q1 = digit(n1, n0 >> 16, d);
    const std::uint32_t q0 = digit(n1, n0 & 0xffff, d);
    return {q1 << 16 | q0, n1};
  }

  /// (n1, n0) / d with n1 < d.
  static Division by_32_bits(std::uint32_t n1, std::uint32_t n0, std::uint32_t d) {
    const int shift = __builtin_clz(d);
    if (shift == 0) return by_normalised(n1, n0, d);
    Division q = by_normalised(n1 << shift | n0 >> (32 - shift), n0 << shift, d << shift);
    q.rest >>= shift;
    return q;
  }

  /// d has more than 32 bits, so that the quotient has at most 32.
  static std::uint32_t by_64_bits(std::uint64_t n, std::uint64_t d, std::uint64_t& rest) {
    rest = n;
    if (n < d) return 0;
    const int shift = __builtin_clz(upper(d));
    const std::uint64_t half = n >> 1;
    std::uint32_t q =
        by_normalised(upper(half), lower(half), upper(d << shift)).quotient >> (31 - shift);
    if (q != 0) --q;
    rest = n - d * q;
    if (rest < d) return q;
    rest -= d;
    return q + 1;
  }
};

}  // namespace lamplock::rp2040
