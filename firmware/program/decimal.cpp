#include "firmware/program/decimal.hpp"

#include <bit>

#include "firmware/program/wide_number.hpp"
#include "shared/fixed_point.hpp"

namespace lamplock::program {
namespace {

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

GcodeError root(std::int64_t a_e9, std::int64_t& result_e9) {
  if (a_e9 < 0) return GcodeError::argument_out_of_range;
  const Int128 square = Int128::product(a_e9, one_e9);
  const auto down = static_cast<std::int64_t>(wide_root(square));
  const bool up = square - Int128::product(down, down) > Int128(down);
  result_e9 = down + (up ? 1 : 0);
  return GcodeError::none;
}

}  // namespace

namespace {

/// The next 32 bits of (rest, next) / d: rest < d, d normalised; leaves the new rest. Knuth, "The
/// Art of Computer Programming", vol. 2, 4.3.1, algorithm D.
std::uint32_t quotient_digit(std::uint64_t& rest, std::uint32_t next, std::uint64_t d) {
  const auto d1 = static_cast<std::uint32_t>(d >> 32), d0 = static_cast<std::uint32_t>(d);
  std::uint64_t guess = rest / d1, left = rest % d1;
  // At most two too large; if `left` exceeds 32 bits the guess is right.
  while (left >> 32 == 0 && (guess >> 32 != 0 || wide_product(static_cast<std::uint32_t>(guess),
                                                              d0) > (left << 32 | next))) {
    --guess;
    left += d1;
  }
  rest = (rest << 32 | next) - guess * d;
  return static_cast<std::uint32_t>(guess);
}

}  // namespace

std::int64_t remainder_e9(std::int64_t a_e9, std::int64_t b_e9) {
  const std::int64_t rest = a_e9 % b_e9;
  return rest < 0 ? rest + abs64(b_e9) : rest;
}

std::uint64_t nearest_quotient(Int128 numerator, std::uint64_t denominator) {
  if (numerator.negative()) numerator = -numerator;
  numerator = numerator + Int128(0, denominator / 2);
  std::uint64_t rest = static_cast<std::uint64_t>(numerator.hi()), low = numerator.lo();
  if (rest >= denominator) return does_not_fit;
  std::uint64_t quotient = 0;
  if (rest == 0) {
    quotient = low / denominator;
  } else if (denominator >> 32 == 0) {
    rest = rest << 32 | low >> 32;
    quotient = rest / denominator << 32;
    quotient += (rest % denominator << 32 | static_cast<std::uint32_t>(low)) / denominator;
  } else {
    const int shift = std::countl_zero(denominator);
    const Int128 n = numerator << shift;
    denominator <<= shift;
    rest = static_cast<std::uint64_t>(n.hi());
    low = n.lo();
    quotient = quotient_digit(rest, static_cast<std::uint32_t>(low >> 32), denominator);
    quotient = quotient << 32 | quotient_digit(rest, static_cast<std::uint32_t>(low), denominator);
  }
  return quotient < does_not_fit ? quotient : does_not_fit;
}

GcodeError product_e9(std::int64_t a_e9, std::int64_t b_e9, std::int64_t& result_e9) {
  const Int128 product = Int128::product(a_e9, b_e9);
  return with_sign(nearest_quotient(product, static_cast<std::uint64_t>(one_e9)),
                   product.negative(), result_e9);
}

GcodeError quotient_e9(std::int64_t a_e9, std::int64_t b_e9, std::int64_t& result_e9) {
  constexpr auto unit = static_cast<std::uint64_t>(one_e9);
  const std::uint64_t a = magnitude(a_e9), b = magnitude(b_e9), whole_b = b / unit;
  // Programs divide by whole numbers most often: 10^9 in both then has no effect.
  const std::uint64_t size = whole_b * unit == b
                                 ? nearest_quotient(Int128(0, a), whole_b)
                                 : nearest_quotient(Int128::product(a_e9, one_e9), b);
  return with_sign(size, (a_e9 < 0) != (b_e9 < 0), result_e9);
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
      result_e9 = remainder_e9(a_e9, b_e9);
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
      return arc_function_e9(function, a_e9, result_e9);
    case Function::cos:
      result_e9 = cosine_e9(a_e9);
      return GcodeError::none;
    case Function::sin:
      result_e9 = sine_e9(a_e9);
      return GcodeError::none;
    case Function::tan:
      return tangent_e9(a_e9, result_e9);
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

}  // namespace lamplock::program
