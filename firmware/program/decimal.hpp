// Numbers of expressions: exact decimals, whole multiples of 10^-9 ("e9") below 9.2 10^9.
//
// In:  operands of the operators and functions of RS-274/NGC.
// Out: the result, rounded once to the nearest multiple of 10^-9, or an error: division by zero, an
//      argument that the function does not have, a result that is too large.
// Who: expressions (expression.hpp), main loop. An operation takes some hundred to some thousand
//      cycles.
//
// Decimals because programs are: a million additions of 0.1 are exactly 100 000, as binary
// fractions they are not. Sums, differences and remainders are exact. Sine, cosine, square root and
// the angles are within 10^-9; powers, exponentials and logarithms within 10^-9 or 10^-15 of the
// result, whichever is larger. A tangent has the error of a sine divided by its cosine.
#pragma once

#include <cstdint>

#include "shared/gcode_errors.hpp"
#include "shared/int128.hpp"

namespace lamplock::program {

inline constexpr std::int64_t one_e9 = 1'000'000'000;

/// Operators with two operands, in groups of the same precedence, from the lowest; within a group
/// they are executed from left to right.
enum class Operator : std::uint8_t {
  logical_and,
  logical_or,
  logical_xor,
  equal,
  not_equal,
  greater,
  greater_equal,
  less,
  less_equal,
  plus,
  minus,
  times,
  divide,
  modulo,
  power
};

/// Functions with one operand. Angles are in degrees.
enum class Function : std::uint8_t {
  abs,
  acos,
  asin,
  cos,
  exp,
  fix,  ///< the next lower whole number
  fup,  ///< the next higher one
  ln,
  round,  ///< the nearest one; half away from zero
  sin,
  sqrt,
  tan
};

/// Two numbers that differ by less are equal for EQ and NE, as in LinuxCNC.
inline constexpr std::int64_t equal_tolerance_e9 = 100'000;

/// a op b. Comparisons and logical operators give 1 or 0. MOD is never negative. Errors:
/// division_by_zero, argument_out_of_range (a negative number to a power that is not whole),
/// result_too_large.
[[gnu::cold]] GcodeError calculate(Operator op, std::int64_t a_e9, std::int64_t b_e9,
                                   std::int64_t& result_e9);

/// function(a). Errors: argument_out_of_range (root of a negative number, logarithm of a number
/// that is not positive, arc sine or cosine beyond 1), division_by_zero (TAN[90]),
/// result_too_large.
[[gnu::cold]] GcodeError calculate(Function function, std::int64_t a_e9, std::int64_t& result_e9);

/// ATAN[y]/[x]: angle of the vector (x, y) in degrees, from -180 to 180; 0 for the zero vector.
[[gnu::cold]] std::int64_t arc_tangent_e9(std::int64_t y_e9, std::int64_t x_e9);

// For the operators and functions themselves.

/// |numerator| / denominator to the nearest whole number, half up; 2^63 if it does not fit into 63
/// bits. numerator below 2^126, denominator from 1 to 2^63.
[[gnu::cold]] std::uint64_t nearest_quotient(Int128 numerator, std::uint64_t denominator);

/// a b 10^-9 and 10^9 a / b; b is not 0 in a quotient.
[[gnu::cold]] GcodeError product_e9(std::int64_t a_e9, std::int64_t b_e9, std::int64_t& result_e9);
[[gnu::cold]] GcodeError quotient_e9(std::int64_t a_e9, std::int64_t b_e9, std::int64_t& result_e9);

/// a mod b, from 0 to |b|; b is not 0.
[[gnu::cold]] std::int64_t remainder_e9(std::int64_t a_e9, std::int64_t b_e9);

/// Sine, cosine and tangent of an angle in degrees; ASIN or ACOS (decimal_angle.cpp).
[[gnu::cold]] std::int64_t sine_e9(std::int64_t angle_e9);
[[gnu::cold]] std::int64_t cosine_e9(std::int64_t angle_e9);
[[gnu::cold]] GcodeError tangent_e9(std::int64_t angle_e9, std::int64_t& result_e9);
[[gnu::cold]] GcodeError arc_function_e9(Function function, std::int64_t a_e9,
                                         std::int64_t& result_e9);

/// a to the power of b; e to the power of a; the natural logarithm of a (decimal_power.cpp).
[[gnu::cold]] GcodeError power_e9(std::int64_t a_e9, std::int64_t b_e9, std::int64_t& result_e9);
[[gnu::cold]] GcodeError exponential_e9(std::int64_t a_e9, std::int64_t& result_e9);
[[gnu::cold]] GcodeError logarithm_e9(std::int64_t a_e9, std::int64_t& result_e9);

}  // namespace lamplock::program
