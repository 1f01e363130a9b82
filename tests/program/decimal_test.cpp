// Decimals of expressions against exact integers of 128 bits and against floating point of 64 bits.
#include "firmware/program/decimal.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/native_int128.hpp"

namespace lamplock::program {
namespace {

using lamplock::test::Native;
using Real = long double;
using Random = std::mt19937_64;

constexpr Real unit = 1e-9L;

/// A number of any size up to 2^bits, in 10^-9.
std::int64_t random_e9(Random& random, int bits) {
  const int used = 1 + static_cast<int>(random() % static_cast<unsigned>(bits));
  const auto size = static_cast<std::int64_t>(random() >> (64 - used));
  return random() % 2 == 0 ? size : -size;
}

/// Nearest whole number to a / b, half away from zero.
Native rounded(Native a, Native b) {
  const bool negative = (a < 0) != (b < 0);
  const Native n = a < 0 ? -a : a, d = b < 0 ? -b : b;
  const Native q = (n + d / 2) / d;
  return negative ? -q : q;
}

TEST(Decimal, ProductsAndQuotientsAreRoundedOnce) {
  Random random(1);
  int products = 0, quotients = 0;
  for (int i = 0; i < 200'000; ++i) {
    const std::int64_t a = random_e9(random, 63), b = random_e9(random, 63);
    std::int64_t result = 0;
    const Native product = rounded(Native{a} * b, one_e9);
    const bool fits = product <= INT64_MAX && product >= -INT64_MAX;
    const GcodeError error = calculate(Operator::times, a, b, result);
    ASSERT_EQ(error, fits ? GcodeError::none : GcodeError::result_too_large) << a << " " << b;
    if (fits) {
      ASSERT_EQ(result, product) << a << " * " << b;
    }
    products += fits ? 1 : 0;
    if (b == 0) continue;
    const Native quotient = rounded(Native{a} * one_e9, b);
    const bool quotient_fits = quotient <= INT64_MAX && quotient >= -INT64_MAX;
    ASSERT_EQ(calculate(Operator::divide, a, b, result),
              quotient_fits ? GcodeError::none : GcodeError::result_too_large);
    if (quotient_fits) {
      ASSERT_EQ(result, quotient) << a << " / " << b;
    }
    quotients += quotient_fits ? 1 : 0;
  }
  EXPECT_GT(products, 50'000);
  EXPECT_GT(quotients, 50'000);
}

TEST(Decimal, SumsThatDoNotFitAreErrors) {
  std::int64_t result = 0;
  EXPECT_EQ(calculate(Operator::plus, INT64_MAX, 1, result), GcodeError::result_too_large);
  EXPECT_EQ(calculate(Operator::minus, -INT64_MAX, 1, result), GcodeError::result_too_large);
  EXPECT_EQ(calculate(Operator::minus, -INT64_MAX, -INT64_MAX, result), GcodeError::none);
  EXPECT_EQ(calculate(Function::fup, INT64_MAX, result), GcodeError::result_too_large);
  EXPECT_EQ(calculate(Operator::equal, INT64_MAX, -INT64_MAX, result), GcodeError::none);
  EXPECT_EQ(result, 0);
}

/// |got - wanted|, in 10^-9 or in 10^-15 of the value, whichever is larger.
Real error_of(std::int64_t got_e9, Real wanted) {
  const Real scale = std::max(unit, std::abs(wanted) * 1e-15L);
  return std::abs(static_cast<Real>(got_e9) * unit - wanted) / scale;
}

Real real(std::int64_t e9) { return static_cast<Real>(e9) * unit; }

TEST(Decimal, FunctionsAreWithinAUnit) {
  constexpr Real degree = std::numbers::pi_v<Real> / 180;
  Random random(2);
  Real worst = 0;
  const auto compare = [&](Function function, std::int64_t a, Real wanted) {
    std::int64_t result = 0;
    ASSERT_EQ(calculate(function, a, result), GcodeError::none) << real(a);
    ASSERT_LT(error_of(result, wanted), 1) << static_cast<int>(function) << " of " << real(a);
    worst = std::max(worst, error_of(result, wanted));
  };
  for (int i = 0; i < 50'000; ++i) {
    const std::int64_t any = random_e9(random, 63), angle = random_e9(random, 45);
    const std::int64_t fraction = random_e9(random, 60) % (one_e9 + 1);
    compare(Function::sin, angle, std::sin(real(angle % (360 * one_e9)) * degree));
    compare(Function::cos, angle, std::cos(real(angle % (360 * one_e9)) * degree));
    compare(Function::asin, fraction, std::asin(real(fraction)) / degree);
    compare(Function::acos, fraction, std::acos(real(fraction)) / degree);
    compare(Function::sqrt, std::abs(any), std::sqrt(real(std::abs(any))));
    if (any != 0) compare(Function::ln, std::abs(any), std::log(real(std::abs(any))));
    const std::int64_t exponent = random_e9(random, 60) % (22 * one_e9);
    compare(Function::exp, exponent, std::exp(real(exponent)));
    const std::int64_t y = random_e9(random, 63);
    const Real angle_wanted = std::atan2(real(y), real(any)) / degree;
    if (any != 0 || y != 0) {
      ASSERT_LT(error_of(arc_tangent_e9(y, any), angle_wanted), 1) << real(y) << " " << real(any);
    }
    if (::testing::Test::HasFatalFailure()) return;
  }
}

TEST(Decimal, PowersFollowTheirDigits) {
  Random random(3);
  int compared = 0;
  for (int i = 0; i < 100'000; ++i) {
    const std::int64_t a = random_e9(random, 40), b = random_e9(random, 36);
    const bool whole = random() % 2 == 0;
    const std::int64_t exponent = whole ? b / one_e9 * one_e9 : b;
    if (a == 0 || (a < 0 && !whole)) continue;
    const Real wanted = std::pow(real(a), real(exponent));
    std::int64_t result = 0;
    const GcodeError error = calculate(Operator::power, a, exponent, result);
    if (std::abs(wanted) > 9.2e9L) continue;
    ASSERT_EQ(error, GcodeError::none) << real(a) << " ** " << real(exponent);
    // Factors are rounded to 10^-9: at most 16 of them, each with an error of half a unit.
    const Real factors = 10e-9L * std::max({Real{1}, std::abs(wanted / real(a)), std::abs(wanted)});
    ASSERT_LE(std::abs(real(result) - wanted), factors) << real(a) << " ** " << real(exponent);
    ++compared;
  }
  EXPECT_GT(compared, 30'000);
}

TEST(Decimal, WholePowersAreExact) {
  for (std::int64_t base = -9; base <= 9; ++base)
    for (std::int64_t n = 0, power = 1; n < 12 && std::abs(power) < 9'000'000'000;
         ++n, power *= base) {
      std::int64_t result = 0;
      ASSERT_EQ(calculate(Operator::power, base * one_e9, n * one_e9, result), GcodeError::none);
      ASSERT_EQ(result, power * one_e9) << base << " ** " << n;
    }
}

}  // namespace
}  // namespace lamplock::program
