#include "firmware/program/decimal.hpp"

#include <bit>

#include "firmware/program/angle.hpp"
#include "firmware/program/wide_number.hpp"
#include "shared/fixed_point.hpp"

namespace lamplock::program {
namespace {

/// A turn is 360 10^9 = 2^9 703125000.
constexpr std::uint32_t degrees_of_turn = 703'125'000;
constexpr int degrees_shift = turn_bits - 9;
constexpr std::int64_t turn_e9 = 360 * one_e9, half_turn_e9 = 180 * one_e9;
constexpr std::uint64_t does_not_fit = std::uint64_t{1} << 63;

constexpr std::int64_t truth(bool is_true) { return is_true ? one_e9 : 0; }

constexpr std::uint64_t magnitude(std::int64_t value) {
  return value < 0 ? 0 - static_cast<std::uint64_t>(value) : static_cast<std::uint64_t>(value);
}

GcodeError with_sign(std::uint64_t size, bool negative, std::int64_t& result_e9) {
  if (size >= does_not_fit) return GcodeError::result_too_large;
  result_e9 = negative ? -static_cast<std::int64_t>(size) : static_cast<std::int64_t>(size);
  return GcodeError::none;
}

GcodeError sum(std::int64_t a_e9, std::int64_t b_e9, std::int64_t& result_e9) {
  return __builtin_add_overflow(a_e9, b_e9, &result_e9) || result_e9 == INT64_MIN
             ? GcodeError::result_too_large
             : GcodeError::none;
}

std::int64_t remainder(std::int64_t a_e9, std::int64_t b_e9) {
  const std::int64_t rest = a_e9 % b_e9;
  return rest < 0 ? rest + abs64(b_e9) : rest;
}

bool compare(Operator op, std::int64_t a_e9, std::int64_t b_e9) {
  switch (op) {
    case Operator::logical_and:
      return a_e9 != 0 && b_e9 != 0;
    case Operator::logical_or:
      return a_e9 != 0 || b_e9 != 0;
    case Operator::logical_xor:
      return (a_e9 != 0) != (b_e9 != 0);
    case Operator::greater:
      return a_e9 > b_e9;
    case Operator::greater_equal:
      return a_e9 >= b_e9;
    case Operator::less:
      return a_e9 < b_e9;
    case Operator::less_equal:
      return a_e9 <= b_e9;
    default: {
      const Int128 difference = Int128(a_e9) - Int128(b_e9);
      const bool equal =
          difference < Int128(equal_tolerance_e9) && difference > Int128(-equal_tolerance_e9);
      return equal == (op == Operator::equal);
    }
  }
}

/// Half a unit below and above are rounded away from zero.
GcodeError whole(Function function, std::int64_t a_e9, std::int64_t& result_e9) {
  std::int64_t rest = a_e9 % one_e9;
  const std::int64_t towards_zero = a_e9 - rest;
  bool up = false, down = false;
  if (function == Function::fix) down = rest < 0;
  if (function == Function::fup) up = rest > 0;
  if (function == Function::round) {
    up = rest >= one_e9 / 2;
    down = rest <= -one_e9 / 2;
  }
  return sum(towards_zero, up ? one_e9 : down ? -one_e9 : 0, result_e9);
}

SineCosine of_degrees(std::int64_t angle_e9) {
  const std::int64_t in_turn = remainder(angle_e9, turn_e9);
  return sine_cosine(mul_div(in_turn, std::int64_t{1} << degrees_shift, degrees_of_turn));
}

std::int64_t from_q48(std::int64_t value_q48) {
  const Int128 half(std::int64_t{1} << (turn_bits - 1));
  return ((Int128::product(value_q48, one_e9) + half) >> turn_bits).to_int64();
}

std::int64_t degrees_of(std::int64_t angle_q48) {
  const Int128 half(std::int64_t{1} << (degrees_shift - 1));
  return ((Int128::product(angle_q48, degrees_of_turn) + half) >> degrees_shift).to_int64();
}

GcodeError tangent(std::int64_t angle_e9, std::int64_t& result_e9) {
  const SineCosine at = of_degrees(angle_e9);
  if (at.cosine_q48 == 0) return GcodeError::division_by_zero;
  return quotient_e9(at.sine_q48, at.cosine_q48, result_e9);
}

/// The angle of a point on a circle of radius 1.
GcodeError arc_function(Function function, std::int64_t a_e9, std::int64_t& result_e9) {
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

GcodeError root(std::int64_t a_e9, std::int64_t& result_e9) {
  if (a_e9 < 0) return GcodeError::argument_out_of_range;
  const Int128 square = Int128::product(a_e9, one_e9);
  const auto down = static_cast<std::int64_t>(wide_root(square));
  const bool up = square - Int128::product(down, down) > Int128(down);
  result_e9 = down + (up ? 1 : 0);
  return GcodeError::none;
}

}  // namespace

std::uint64_t nearest_quotient(Int128 numerator, std::uint64_t denominator) {
  if (numerator.negative()) numerator = -numerator;
  numerator = numerator + Int128(0, denominator / 2);
  const auto high = static_cast<std::uint64_t>(numerator.hi());
  if (high >= denominator) return does_not_fit;
  if (high == 0) return numerator.lo() / denominator;
  std::uint64_t rest = high, digits = numerator.lo();
  for (int bit = 0; bit < 64; ++bit) {
    const bool carry = rest >> 63 != 0;
    rest = rest << 1 | digits >> 63;
    digits <<= 1;
    if (!carry && rest < denominator) continue;
    rest -= denominator;
    digits |= 1;
  }
  return digits < does_not_fit ? digits : does_not_fit;
}

GcodeError product_e9(std::int64_t a_e9, std::int64_t b_e9, std::int64_t& result_e9) {
  const Int128 product = Int128::product(a_e9, b_e9);
  return with_sign(nearest_quotient(product, static_cast<std::uint64_t>(one_e9)),
                   product.negative(), result_e9);
}

GcodeError quotient_e9(std::int64_t a_e9, std::int64_t b_e9, std::int64_t& result_e9) {
  return with_sign(nearest_quotient(Int128::product(a_e9, one_e9), magnitude(b_e9)),
                   (a_e9 < 0) != (b_e9 < 0), result_e9);
}

GcodeError calculate(Operator op, std::int64_t a_e9, std::int64_t b_e9, std::int64_t& result_e9) {
  switch (op) {
    case Operator::plus:
      return sum(a_e9, b_e9, result_e9);
    case Operator::minus:
      return sum(a_e9, -b_e9, result_e9);
    case Operator::times:
      return product_e9(a_e9, b_e9, result_e9);
    case Operator::divide:
      if (b_e9 == 0) return GcodeError::division_by_zero;
      return quotient_e9(a_e9, b_e9, result_e9);
    case Operator::modulo:
      if (b_e9 == 0) return GcodeError::division_by_zero;
      result_e9 = remainder(a_e9, b_e9);
      return GcodeError::none;
    case Operator::power:
      return power_e9(a_e9, b_e9, result_e9);
    default:
      result_e9 = truth(compare(op, a_e9, b_e9));
      return GcodeError::none;
  }
}

GcodeError calculate(Function function, std::int64_t a_e9, std::int64_t& result_e9) {
  switch (function) {
    case Function::abs:
      result_e9 = abs64(a_e9);
      return GcodeError::none;
    case Function::acos:
    case Function::asin:
      return arc_function(function, a_e9, result_e9);
    case Function::cos:
      result_e9 = from_q48(of_degrees(a_e9).cosine_q48);
      return GcodeError::none;
    case Function::sin:
      result_e9 = from_q48(of_degrees(a_e9).sine_q48);
      return GcodeError::none;
    case Function::tan:
      return tangent(a_e9, result_e9);
    case Function::exp:
      return exponential_e9(a_e9, result_e9);
    case Function::ln:
      return logarithm_e9(a_e9, result_e9);
    case Function::sqrt:
      return root(a_e9, result_e9);
    default:
      return whole(function, a_e9, result_e9);
  }
}

std::int64_t arc_tangent_e9(std::int64_t y_e9, std::int64_t x_e9) {
  const std::int64_t degrees = degrees_of(angle_of(Int128(x_e9), Int128(y_e9)));
  return degrees > half_turn_e9 || y_e9 < 0 ? degrees - turn_e9 : degrees;
}

}  // namespace lamplock::program
