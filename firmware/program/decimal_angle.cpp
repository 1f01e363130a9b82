// Sines, cosines, tangents and their inverse functions of decimals, in degrees.
//
// Angles are reduced in decimals, which is exact: sines of multiples of 90 degrees are exact. Below
// 45 degrees the series of sine and cosine have seven terms, the next is below 10^-12.
// (Abramowitz and Stegun, "Handbook of Mathematical Functions", 4.3.65 and 4.3.66.) One product a
// term and no table of angles: expressions run from flash, where code and tables are slow that are
// used once a line.
#include <array>

#include "firmware/program/angle.hpp"
#include "firmware/program/decimal.hpp"
#include "firmware/program/wide_number.hpp"
#include "shared/fixed_point.hpp"

namespace lamplock::program {
namespace {

constexpr std::int64_t turn_e9 = 360 * one_e9, half_turn_e9 = 180 * one_e9;
constexpr std::int64_t quarter_e9 = 90 * one_e9, eighth_e9 = 45 * one_e9;

/// Radians of 10^-9 degrees, 2^-99: (pi / 4) / 45 10^9, and 45 10^9 = 2^9 87890625. An eighth has
/// 36 bits, with 28 more it fills 64.
constexpr int eighth_shift = 28;
constexpr auto radians_q99 = static_cast<std::uint64_t>(
    mul_div(radians_of_eighth_q62, std::int64_t{1} << (99 - 62 - 9), 87'890'625));

constexpr int angle_terms = 7;
/// 1 / 1!, 1 / 3!, ... of the sine, or 1 / 0!, 1 / 2!, ... of the cosine, the last one first.
constexpr std::array<std::uint64_t, angle_terms> angle_coefficients_q62(bool sine) {
  std::array<std::uint64_t, angle_terms> table{};
  std::uint64_t coefficient = std::uint64_t{one_q62};
  for (std::uint32_t i = 0; i < angle_terms; ++i) {
    table[angle_terms - 1 - i] = coefficient;
    const std::uint32_t n = 2 * i + (sine ? 2 : 1);
    coefficient /= std::uint64_t{n} * (n + 1);
  }
  return table;
}
constexpr std::array<std::uint64_t, angle_terms> angle_series_q62[2] = {
    angle_coefficients_q62(true), angle_coefficients_q62(false)};

/// a b 2^-64, at most 2 below it.
[[gnu::noinline]] std::uint64_t upper_product(std::uint64_t a, std::uint64_t b) {
  const auto a1 = static_cast<std::uint32_t>(a >> 32), a0 = static_cast<std::uint32_t>(a);
  const auto b1 = static_cast<std::uint32_t>(b >> 32), b0 = static_cast<std::uint32_t>(b);
  return wide_product(a1, b1) + (wide_product(a1, b0) >> 32) + (wide_product(a0, b1) >> 32);
}

constexpr std::uint32_t degrees_of_turn = 703'125'000;  // 360 10^9 / 2^9
constexpr int degrees_shift = turn_bits - 9;

[[gnu::cold]] std::int64_t sine_q62(std::int64_t angle_e9) {
  std::int64_t rest_e9 =
      angle_e9 >= 0 && angle_e9 < turn_e9 ? angle_e9 : remainder_e9(angle_e9, turn_e9);
  const bool negative = rest_e9 >= half_turn_e9;
  if (negative) rest_e9 -= half_turn_e9;
  if (rest_e9 > quarter_e9) rest_e9 = half_turn_e9 - rest_e9;
  const bool is_large = rest_e9 > eighth_e9;
  if (is_large) rest_e9 = quarter_e9 - rest_e9;
  const std::uint64_t x_q64 =
      upper_product(static_cast<std::uint64_t>(rest_e9) << eighth_shift, radians_q99) << 1;
  const std::uint64_t square_q64 = upper_product(x_q64, x_q64);
  std::uint64_t sum_q62 = 0;
  for (const std::uint64_t coefficient : angle_series_q62[is_large ? 1 : 0])
    sum_q62 = coefficient - upper_product(square_q64, sum_q62);
  if (!is_large) sum_q62 = upper_product(x_q64, sum_q62);
  const auto sine = static_cast<std::int64_t>(sum_q62);
  return negative ? -sine : sine;
}

std::int64_t degrees_of(std::int64_t angle_q48) {
  const Int128 half(std::int64_t{1} << (degrees_shift - 1));
  return ((Int128::product(angle_q48, degrees_of_turn) + half) >> degrees_shift).to_int64();
}

}  // namespace

std::int64_t sine_e9(std::int64_t angle_e9) {
  const std::int64_t sine = sine_q62(angle_e9);
  const auto size_q62 = static_cast<std::uint64_t>(abs64(sine));
  const std::uint64_t e9_q30 = upper_product(size_q62, std::uint64_t{one_e9} << 32);
  const auto size = static_cast<std::int64_t>((e9_q30 + (1u << 29)) >> 30);
  return sine < 0 ? -size : size;
}

std::int64_t cosine_e9(std::int64_t angle_e9) {
  // A quarter more or three less: the sum does not overflow, and angles of the first turn need no
  // division.
  return sine_e9(angle_e9 < turn_e9 ? angle_e9 + quarter_e9 : angle_e9 - (turn_e9 - quarter_e9));
}

GcodeError tangent_e9(std::int64_t angle_e9, std::int64_t& result_e9) {
  const std::int64_t in_turn_e9 = remainder_e9(angle_e9, turn_e9);
  const std::int64_t cosine_q62 = sine_q62(in_turn_e9 + quarter_e9);
  if (cosine_q62 == 0) return GcodeError::division_by_zero;
  return quotient_e9(sine_q62(in_turn_e9), cosine_q62, result_e9);
}

/// The angle of a point on a circle of radius 1.
GcodeError arc_function_e9(Function function, std::int64_t a_e9, std::int64_t& result_e9) {
  if (abs64(a_e9) > one_e9 || a_e9 == INT64_MIN) return GcodeError::argument_out_of_range;
  constexpr int more_bits = 30;  // of the root, which is small beside 1
  const Int128 square = Int128(one_e9 * one_e9 - a_e9 * a_e9) << (2 * more_bits);
  const Int128 other(static_cast<std::int64_t>(wide_root(square)));
  const Int128 given = Int128(a_e9) << more_bits;
  result_e9 =
      degrees_of(function == Function::acos ? angle_of(given, other) : angle_of(other, given));
  if (result_e9 > half_turn_e9) result_e9 -= turn_e9;
  return GcodeError::none;
}

std::int64_t arc_tangent_e9(std::int64_t y_e9, std::int64_t x_e9) {
  const std::int64_t degrees = degrees_of(angle_of(Int128(x_e9), Int128(y_e9)));
  return degrees > half_turn_e9 || y_e9 < 0 ? degrees - turn_e9 : degrees;
}

}  // namespace lamplock::program
