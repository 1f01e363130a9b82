// Numbers of the line planner compared with long double, which has 64 bits.
#include "firmware/motion/line/real.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

#include "tests/scale.hpp"

namespace lamplock::test {
namespace {

using motion::UFloat;

long double value(UFloat a) {
  return std::ldexp(static_cast<long double>(a.mantissa()), a.exponent());
}

void expect_normal(UFloat a) {
  ASSERT_TRUE(motion::is_zero(a) || (a.mantissa() >> 31) == 1);
  ASSERT_EQ(motion::is_zero(a), a < UFloat::power(-1000));
}

/// Expects `a` not above `exact`, and closer than 2^-bits of it.
void expect_down(UFloat a, long double exact, int bits) {
  expect_normal(a);
  ASSERT_LE(value(a), exact);
  ASSERT_GE(value(a), exact - std::ldexp(exact, -bits));
}

/// Random bits, sometimes with long runs of zeros and ones; some zeros, exponents close together.
class Numbers {
 public:
  UFloat next() {
    if (random_() % 32 == 0) return {};
    auto m = static_cast<std::uint32_t>(random_());
    if (random_() % 4 == 0) m = 0xffffffffu << random_() % 32;
    if (random_() % 4 == 0) m = ~0u >> random_() % 32;
    if (random_() % 4 == 0) m ^= 1u << random_() % 32;
    return UFloat(m, static_cast<int>(random_() % 72) - 36);
  }
  std::uint64_t bits() { return random_() >> random_() % 64; }

 private:
  std::mt19937_64 random_{4711};
};

TEST(UFloat, ResultsAreRoundedDownSlightly) {
  Numbers numbers;
  for (int i = 0; i < scaled(50'000); ++i) {
    const UFloat a = numbers.next(), b = numbers.next();
    const long double x = value(a), y = value(b);
    expect_down(a * b, x * y, 30);
    expect_down(a + b, x + y, 30);
    expect_down(square_root(a), std::sqrt(x), 27);
    // A number less than the last bit of the other is ignored.
    expect_down(difference(a, b), a.exponent() - b.exponent() >= 32 ? x : x > y ? x - y : 0, 31);
    if (!motion::is_zero(b)) expect_down(a / b, x / y, 31);
    ASSERT_EQ(a < b, x < y);
    ASSERT_EQ(value(motion::least(a, b)), std::min(x, y));
    ASSERT_EQ(value(motion::times_power(a, 7)), x * 128);
    ASSERT_FALSE(testing::Test::HasFatalFailure()) << x << " " << y;
  }
}

TEST(UFloat, WholeNumbersAndFixedPoint) {
  Numbers numbers;
  for (int i = 0; i < scaled(20'000); ++i) {
    const UFloat a = numbers.next();
    const long double x = value(a);
    const auto most = static_cast<std::uint32_t>(numbers.bits());
    ASSERT_EQ(motion::whole_down(a, most), std::min<long double>(std::floor(x), most));
    ASSERT_EQ(motion::whole_up(a, most), std::min<long double>(std::ceil(x), most));
    for (const int bits : {0, 20, 40, 62}) {
      const long double fixed = std::floor(std::ldexp(x, bits));
      ASSERT_EQ(a.fixed(bits), fixed < 0x1p62L ? static_cast<std::int64_t>(fixed) : 1LL << 62);
    }
    const std::uint64_t n = numbers.bits();
    expect_down(UFloat(n), static_cast<long double>(n), 31);
    expect_down(motion::LinePacked(a).real(), x, 23);
    ASSERT_FALSE(testing::Test::HasFatalFailure());
  }
}

}  // namespace
}  // namespace lamplock::test
