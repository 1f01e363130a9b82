#include "firmware/program/wide_number.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>

#include "tests/native_int128.hpp"
#include "tests/scale.hpp"

namespace lamplock::program::wide_number_test {
namespace {

using lamplock::test::Native;
using lamplock::test::UnsignedNative;

/// A random number of random width, up to `most` bits.
std::uint64_t of_any_size(std::mt19937_64& random, int most) {
  const auto bits = static_cast<int>(random() % static_cast<unsigned>(most + 1));
  return bits == 0 ? 0 : random() >> (64 - bits);
}

TEST(WideNumber, ProductsAreRoundedToNearest) {
  std::mt19937_64 random(1);
  for (int i = 0; i < lamplock::test::scaled(20000); ++i) {
    auto a = static_cast<std::int64_t>(of_any_size(random, 62));
    auto b = static_cast<std::int64_t>(of_any_size(random, 62));
    if (random() % 2 != 0) a = -a;
    if (random() % 2 != 0) b = -b;
    const Native twice = Native{a} * b * 2 - Native{times_q62(a, b)} * 2 * (Native{1} << 62);
    ASSERT_GE(twice, -(Native{1} << 62)) << a << " " << b;
    ASSERT_LE(twice, Native{1} << 62) << a << " " << b;
  }
}

TEST(WideNumber, ShortProductsAreRoundedTowardsZero) {
  std::mt19937_64 random(4);
  for (int i = 0; i < lamplock::test::scaled(20000); ++i) {
    const auto a = static_cast<std::int64_t>(of_any_size(random, 55));
    const auto b =
        i % 100 == 0 ? std::int64_t{1} << 48 : static_cast<std::int64_t>(of_any_size(random, 48));
    const std::int64_t got = times_q48(a, b);
    const Native less = Native{a} * b - Native{got} * (Native{1} << 48);
    ASSERT_GE(less, 0) << a << " " << b;
    ASSERT_LT(less, 2 * (Native{1} << 48)) << a << " " << b;
    ASSERT_EQ(times_q48(-a, b), -got);
    ASSERT_EQ(times_q48(a, -b), -got);
    ASSERT_EQ(times_q48(-a, -b), got);
  }
}

TEST(WideNumber, QuotientsAreRoundedDown) {
  std::mt19937_64 random(2);
  for (int i = 0; i < lamplock::test::scaled(20000); ++i) {
    const std::uint64_t b = of_any_size(random, 48) | 1;
    const std::uint64_t a = random() % (b + 1);
    const auto exact = (static_cast<UnsignedNative>(a) << 48) / b;
    ASSERT_EQ(static_cast<UnsignedNative>(quotient_q48(a, b)), exact) << a << " " << b;
  }
  EXPECT_EQ(quotient_q48(7, 7), std::int64_t{1} << 48);
  EXPECT_EQ(quotient_q48(0, 7), 0);
  EXPECT_EQ(quotient_q48(0, 0), 0);
}

void expect_root(UnsignedNative x) {
  const std::uint64_t root = wide_root(lamplock::test::to_int128(static_cast<Native>(x)));
  const UnsignedNative r = root;
  ASSERT_LE(r * r, x);
  ASSERT_GT((r + 1) * (r + 1), x);
}

TEST(WideNumber, RootsAreRoundedDown) {
  std::mt19937_64 random(3);
  for (int i = 0; i < lamplock::test::scaled(20000); ++i) {
    const UnsignedNative any = static_cast<UnsignedNative>(random()) << 62 | random() >> 2;
    expect_root(any >> (random() % 126));
    // Squares and their neighbours.
    const UnsignedNative r = of_any_size(random, 63);
    if (r == 0) continue;
    expect_root(r * r);
    expect_root(r * r - 1);
    expect_root(r * r + r + r);
  }
  expect_root(0);
  expect_root((static_cast<UnsignedNative>(1) << 126) - 1);
}

TEST(WideNumber, LengthOfAVector) {
  EXPECT_EQ(length_of(3, -4), 5);
  EXPECT_EQ(length_of(0, 0), 0);
  EXPECT_EQ(length_of(-1, 1), 1);
  EXPECT_EQ(length_of(-300'000'000'000, 400'000'000'000), 500'000'000'000);
}

}  // namespace
}  // namespace lamplock::program::wide_number_test
