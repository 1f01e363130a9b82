// The board's 64-bit division against the PC's; the PC's replaces the 32-bit divider.
#include "firmware/boards/rp2040/base/wide_division.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/scale.hpp"

namespace lamplock::rp2040 {
namespace {

struct PcDivider {
  static Division divide(std::uint32_t n, std::uint32_t d) { return {n / d, n % d}; }
};

void expect_division(std::uint64_t n, std::uint64_t d) {
  std::uint64_t rest = 0;
  ASSERT_EQ(WideDivision<PcDivider>::divide(n, d, rest), n / d) << n << " / " << d;
  ASSERT_EQ(rest, n % d) << n << " % " << d;
}

TEST(WideDivision, EveryLengthOfDividendAndDivisor) {
  std::mt19937_64 random(1);
  for (int i = 0; i < test::scaled(500'000); ++i)
    expect_division(random() >> random() % 64, (random() >> random() % 64) | 1);
}

TEST(WideDivision, NearPowersOfTwoAndExactMultiples) {
  std::mt19937_64 random(2);
  const auto near_power = [&random] {
    const std::uint64_t x = (std::uint64_t{1} << random() % 64) + random() % 5 - 2;
    return x == 0 ? 1 : x;
  };
  for (int i = 0; i < test::scaled(500'000); ++i) {
    const std::uint64_t d = near_power();
    expect_division(near_power(), d);
    const std::uint64_t q = ~std::uint64_t{0} / d;
    expect_division(d * (q == 0 ? 0 : random() % q) + random() % 3 - 1, d);
  }
}

}  // namespace
}  // namespace lamplock::rp2040
