// Exponential function, logarithm and powers of decimals.
//
// e^x: x = k ln 2 + r with |r| < 0.347; the series of e^r has 15 terms, the next is below 10^-19.
// ln x: x = m 2^k with m from 0.7 to 1.42; ln m = 2 artanh(z), z = (m - 1) / (m + 1), |z| < 0.172;
// 12 terms, the next is below 10^-20. (Abramowitz and Stegun, "Handbook of Mathematical Functions",
// 4.2.1 and 4.1.27.)
#include <bit>

#include "firmware/program/decimal.hpp"
#include "firmware/program/wide_number.hpp"
#include "shared/fixed_point.hpp"

namespace lamplock::program {
namespace {

constexpr std::int64_t ln2_q62 = 3'196'577'161'300'663'915, ln2_q58 = 199'786'072'581'291'495;
constexpr std::int64_t ln2_e9 = 693'147'181;
/// ln(2^30 / 10^9).
constexpr std::int64_t ln_of_unit_q58 = 20'507'470'163'763'260;
constexpr std::int64_t one_q61 = std::int64_t{1} << 61;
/// Above this the result is too large, below it is 0.
constexpr std::int64_t max_exponent_e9 = 23 * one_e9;
/// Powers of broken numbers with higher exponents are exponentials: rounding adds up in products.
constexpr std::int64_t max_factors = 16;

/// e^(k ln 2 + r), k from -34 to 34.
GcodeError exponential(std::int64_t k, std::int64_t r_q62, std::int64_t& result_e9) {
  std::int64_t sum_q61 = one_q61;
  constexpr std::int64_t terms = 15;
  for (std::int64_t n = terms; n > 0; --n) sum_q61 = one_q61 + times_q62(r_q62, sum_q61) / n;
  const int shift = 61 - static_cast<int>(k);
  const Int128 half = Int128(1) << (shift - 1);
  const Int128 result = (Int128::product(sum_q61, one_e9) + half) >> shift;
  if (result > Int128(INT64_MAX)) return GcodeError::result_too_large;
  result_e9 = result.to_int64();
  return GcodeError::none;
}

/// e^x; x_q58 must be the same number as x_e9.
GcodeError exponential_of(std::int64_t x_e9, std::int64_t x_q58, std::int64_t& result_e9) {
  const std::int64_t k = (x_e9 + (x_e9 < 0 ? -ln2_e9 / 2 : ln2_e9 / 2)) / ln2_e9;
  const Int128 r_q62 = (Int128(x_q58) << 4) - Int128::product(ln2_q62, k);
  return exponential(k, r_q62.to_int64(), result_e9);
}

GcodeError exponential_of(std::int64_t x_e9, std::int64_t& result_e9) {
  if (x_e9 > max_exponent_e9) return GcodeError::result_too_large;
  result_e9 = 0;
  if (x_e9 < -max_exponent_e9) return GcodeError::none;
  constexpr auto divisor = static_cast<std::uint32_t>(one_e9);
  return exponential_of(x_e9, (Int128(x_e9) << 58).divided_by(divisor).to_int64(), result_e9);
}

/// Of a number above zero.
std::int64_t logarithm_q58(std::int64_t a_e9) {
  const auto n = static_cast<std::uint64_t>(a_e9);
  int exponent = 63 - std::countl_zero(n);
  std::int64_t m_q62 = a_e9 << (62 - exponent);  // from 1 to 2
  constexpr std::int64_t root_of_two_q62 = 6'521'908'912'666'391'106;
  if (m_q62 > root_of_two_q62) {
    m_q62 >>= 1;
    ++exponent;
  }
  const Int128 above = Int128(m_q62 - one_q62) << 62;
  const auto size = static_cast<std::int64_t>(
      nearest_quotient(above, static_cast<std::uint64_t>((m_q62 >> 1) + one_q61)));
  const std::int64_t two_z_q62 = above.negative() ? -size : size;
  const std::int64_t square_q62 = times_q62(two_z_q62, two_z_q62) >> 2;
  std::int64_t sum_q62 = 0;
  constexpr std::int64_t terms = 12;
  for (std::int64_t i = terms - 1; i >= 0; --i)
    sum_q62 = times_q62(square_q62, sum_q62) + one_q62 / (2 * i + 1);
  const std::int64_t ln_m_q62 = times_q62(two_z_q62, sum_q62);
  return (ln_m_q62 >> 4) + ln2_q58 * (exponent - 30) + ln_of_unit_q58;
}

std::int64_t from_q58(std::int64_t value_q58) {
  const Int128 half(std::int64_t{1} << 57);
  return ((Int128::product(value_q58, one_e9) + half) >> 58).to_int64();
}

/// a^n by squaring, n >= 0.
GcodeError repeated_product(std::int64_t a_e9, std::int64_t n, std::int64_t& result_e9) {
  std::int64_t result = one_e9;
  for (std::int64_t square = a_e9;;) {
    if ((n & 1) != 0)
      if (const GcodeError error = product_e9(result, square, result); error != GcodeError::none)
        return error;
    n >>= 1;
    if (n == 0) break;
    if (const GcodeError error = product_e9(square, square, square); error != GcodeError::none)
      return error;
  }
  result_e9 = result;
  return GcodeError::none;
}

/// a^b = e^(b ln a) for a above zero.
GcodeError power_of_positive(std::int64_t a_e9, std::int64_t b_e9, std::int64_t& result_e9) {
  const Int128 wide = Int128::product(logarithm_q58(a_e9), b_e9);
  constexpr auto divisor = static_cast<std::uint32_t>(one_e9);
  const Int128 exponent_q58 = wide.divided_by(divisor);
  const Int128 most = Int128(max_exponent_e9 / one_e9) << 58;
  if (exponent_q58 > most) return GcodeError::result_too_large;
  result_e9 = 0;
  if (exponent_q58 < -most) return GcodeError::none;
  const std::int64_t x_q58 = exponent_q58.to_int64();
  return exponential_of(from_q58(x_q58), x_q58, result_e9);
}

/// a^n, n not 0, a not 0.
GcodeError whole_power(std::int64_t a_e9, std::int64_t n, std::int64_t& result_e9) {
  const std::int64_t times = abs64(n);
  if (a_e9 % one_e9 != 0 && times > max_factors) {
    const GcodeError error = power_of_positive(abs64(a_e9), n * one_e9, result_e9);
    if (a_e9 < 0 && (n & 1) != 0) result_e9 = -result_e9;
    return error;
  }
  if (n > 0) return repeated_product(a_e9, times, result_e9);
  // The reciprocal of the number or of its power: of what has more digits.
  if (abs64(a_e9) < one_e9) {
    std::int64_t reciprocal_e9 = 0;
    const GcodeError error = quotient_e9(one_e9, a_e9, reciprocal_e9);
    return error != GcodeError::none ? error : repeated_product(reciprocal_e9, times, result_e9);
  }
  std::int64_t divisor_e9 = 0;
  result_e9 = 0;
  if (repeated_product(a_e9, times, divisor_e9) != GcodeError::none) return GcodeError::none;
  return quotient_e9(one_e9, divisor_e9, result_e9);
}

}  // namespace

GcodeError power_e9(std::int64_t a_e9, std::int64_t b_e9, std::int64_t& result_e9) {
  result_e9 = one_e9;
  if (b_e9 == 0) return GcodeError::none;
  result_e9 = 0;
  if (a_e9 == 0) return b_e9 < 0 ? GcodeError::division_by_zero : GcodeError::none;
  if (b_e9 % one_e9 == 0) return whole_power(a_e9, b_e9 / one_e9, result_e9);
  return a_e9 < 0 ? GcodeError::argument_out_of_range : power_of_positive(a_e9, b_e9, result_e9);
}

GcodeError exponential_e9(std::int64_t a_e9, std::int64_t& result_e9) {
  return exponential_of(a_e9, result_e9);
}

GcodeError logarithm_e9(std::int64_t a_e9, std::int64_t& result_e9) {
  if (a_e9 <= 0) return GcodeError::argument_out_of_range;
  result_e9 = from_q58(logarithm_q58(a_e9));
  return GcodeError::none;
}

}  // namespace lamplock::program
