// Int128 compared with the compiler's own 128-bit integer.
#include "shared/int128.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/native_int128.hpp"
#include "tests/scale.hpp"

namespace lamplock {
namespace {

using test::Native;
using test::native;
using test::to_int128;
using test::UnsignedNative;

/// Numbers of every magnitude, often extreme ones (0, -1, the limits).
class Numbers {
 public:
  std::uint64_t word() {
    switch (random_() % 8) {
      case 0:
        return 0;
      case 1:
        return ~std::uint64_t{0};
      case 2:
        return std::uint64_t{1} << 63;
      case 3:
        return (std::uint64_t{1} << 63) - 1;
      default:
        return random_() >> (random_() % 64);
    }
  }
  std::int64_t signed_word() {
    const std::uint64_t w = word();
    return static_cast<std::int64_t>(random_() % 2 == 0 ? w : 0 - w);
  }
  Int128 wide() { return {word(), word()}; }
  std::uint32_t divisor() {
    const auto d = static_cast<std::uint32_t>(random_() >> (32 + random_() % 32));
    return d == 0 ? 0xffffffffu : d;
  }
  int shift() { return static_cast<int>(random_() % 128); }

 private:
  std::mt19937_64 random_{128};
};

/// Sum of two signed numbers modulo 2^128.
Native wrapping_sum(Native a, Native b) {
  return static_cast<Native>(static_cast<UnsignedNative>(a) + static_cast<UnsignedNative>(b));
}

TEST(Int128, AddsSubtractsAndNegatesModulo2To128) {
  Numbers numbers;
  for (int i = 0; i < test::scaled(100'000); ++i) {
    const Int128 a = numbers.wide(), b = numbers.wide();
    ASSERT_EQ(native(a + b), wrapping_sum(native(a), native(b)));
    ASSERT_EQ(native(a - b), wrapping_sum(native(a), wrapping_sum(~native(b), 1)));
    ASSERT_EQ(native(-a), wrapping_sum(~native(a), 1));
    ASSERT_EQ(native(~a), ~native(a));
  }
}

TEST(Int128, MultipliesExactly) {
  Numbers numbers;
  for (int i = 0; i < test::scaled(100'000); ++i) {
    const std::int64_t a = numbers.signed_word(), b = numbers.signed_word();
    ASSERT_EQ(native(Int128::product(a, b)), Native{a} * b) << a << " * " << b;
  }
}

TEST(Int128, MultipliesFromThirtyTwoBitPiecesLikeTheTarget) {
  Numbers numbers;
  for (int i = 0; i < test::scaled(100'000); ++i) {
    const std::uint64_t a = numbers.word(), b = numbers.word();
    ASSERT_EQ(static_cast<UnsignedNative>(native(Int128::portable_product(a, b))),
              UnsignedNative{a} * b)
        << a << " * " << b;
  }
}

TEST(Int128, ShiftsLikeTheCompiler) {
  Numbers numbers;
  for (int i = 0; i < test::scaled(100'000); ++i) {
    const Int128 a = numbers.wide();
    const int n = numbers.shift();
    ASSERT_EQ(native(a >> n), native(a) >> n) << "right by " << n;
    ASSERT_EQ(native(a << n), static_cast<Native>(static_cast<UnsignedNative>(native(a)) << n))
        << "left by " << n;
  }
}

TEST(Int128, ComparesAsSignedNumbers) {
  Numbers numbers;
  for (int i = 0; i < test::scaled(100'000); ++i) {
    const Int128 a = numbers.wide(), b = i % 5 == 0 ? a : numbers.wide();
    ASSERT_EQ(a < b, native(a) < native(b));
    ASSERT_EQ(a <= b, native(a) <= native(b));
    ASSERT_EQ(a == b, native(a) == native(b));
    ASSERT_EQ(a.negative(), native(a) < 0);
  }
}

TEST(Int128, DividesTowardsMinusInfinity) {
  Numbers numbers;
  for (int i = 0; i < test::scaled(100'000); ++i) {
    const Int128 a = numbers.wide();
    const std::uint32_t d = numbers.divisor();
    Native floor = native(a) / d;
    if (native(a) % d < 0) --floor;
    ASSERT_EQ(native(a.divided_by(d)), floor) << "by " << d;
  }
}

TEST(Int128, ConvertsSixtyFourBitNumbersWithTheirSign) {
  Numbers numbers;
  for (int i = 0; i < test::scaled(10'000); ++i) {
    const std::int64_t a = numbers.signed_word();
    ASSERT_EQ(native(Int128(a)), Native{a});
    ASSERT_EQ(Int128(a).to_int64(), a);
    ASSERT_EQ(to_int128(Native{a}), Int128(a));
  }
}

}  // namespace
}  // namespace lamplock
