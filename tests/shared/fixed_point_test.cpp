// Rounding of the fixed-point helpers.
#include "shared/fixed_point.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/native_int128.hpp"
#include "tests/scale.hpp"

namespace lamplock {
namespace {

using test::Native;
using test::UnsignedNative;

/// Random magnitude of up to `bits` bits, every length equally often.
std::uint64_t any_length(std::mt19937_64& random, int bits) {
  return random() >> (64 - bits + static_cast<int>(random() % static_cast<std::uint64_t>(bits)));
}

void expect_root(std::uint64_t x) {
  const std::uint64_t r = isqrt(x);
  ASSERT_LE(r * r, x) << "root of " << x;
  ASSERT_GT(UnsignedNative{r + 1} * (r + 1), x) << "root of " << x;
}

TEST(FixedPoint, IsqrtIsTheLargestRootNotAboveTheNumber) {
  for (std::uint64_t x = 0; x < 70'000; ++x) expect_root(x);
  std::mt19937_64 random(1);
  for (int i = 0; i < test::scaled(200'000); ++i) {
    expect_root(any_length(random, 64));
    const std::uint64_t r = random() >> (32 + random() % 32);
    expect_root(r * r);
    if (r != 0) expect_root(r * r - 1);
    expect_root(r * r + 2 * r);  // one below the next square
  }
  expect_root(~std::uint64_t{0});
}

TEST(FixedPoint, RootsOfQ32NumbersAreRoundedDown) {
  std::mt19937_64 random(2);
  for (int i = 0; i < test::scaled(200'000); ++i) {
    const auto x = static_cast<std::int64_t>(any_length(random, 63));
    const std::int64_t down = sqrt_down_q32(x);
    const Native square = Native{x} << 32;
    ASSERT_LE(Native{down} * down, square) << x;
    // Thirty-one significant bits: at most two units of the last one below the exact root.
    const Native above = Native{down} + (down >> 30) + 1;
    ASSERT_GT(above * above, square) << x;
  }
  EXPECT_EQ(sqrt_down_q32(0), 0);
  EXPECT_EQ(sqrt_down_q32(-5), 0);
  EXPECT_EQ(sqrt_down_q32(4 * one_q32), 2 * one_q32);
}

TEST(FixedPoint, QuotientsAndProductsRoundDown) {
  std::mt19937_64 random(3);
  for (int i = 0; i < test::scaled(200'000); ++i) {
    auto a = static_cast<std::int64_t>(any_length(random, 62));
    auto b = static_cast<std::int64_t>(any_length(random, 31));
    if (random() % 2 != 0) a = -a;
    if (random() % 2 != 0) b = -b;
    const auto c =
        static_cast<std::uint32_t>(abs64(b) + static_cast<std::int64_t>(random() % 1000) + 1);
    Native quotient = Native{a} * b / c;
    if (Native{a} * b % c < 0) --quotient;
    ASSERT_EQ(Native{mul_div(a, b, c)}, quotient) << a << " * " << b << " / " << c;
    ASSERT_EQ(Native{mul_q32(a, b)}, (Native{a} * b) >> 32);
  }
}

TEST(FixedPoint, ShortFactorsGiveTheSameProductInPieces) {
  std::mt19937_64 random(4);
  for (int i = 0; i < test::scaled(200'000); ++i) {
    auto x = static_cast<std::int64_t>(any_length(random, 63));
    if (random() % 2 != 0) x = -x;
    const auto n = static_cast<std::uint32_t>(random() >> (48 + random() % 16));
    const auto product = static_cast<std::int64_t>(static_cast<std::uint64_t>(x) * n);
    ASSERT_EQ(portable_times_short(x, n), product) << x << " * " << n;
    ASSERT_EQ(times_short(x, n), product);
  }
}

}  // namespace
}  // namespace lamplock
