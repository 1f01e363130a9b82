#include "firmware/program/angle.hpp"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <cstdint>
#include <random>

#include "tests/native_int128.hpp"
#include "tests/scale.hpp"

namespace lamplock::program::angle_test {
namespace {

using Exact = boost::multiprecision::cpp_bin_float_50;

constexpr std::int64_t one_q48 = std::int64_t{1} << 48;
Exact two_pi() { return 8 * atan(Exact(1)); }

/// Larger of the errors of sine and cosine.
double error_at(std::int64_t angle_q48) {
  const Exact x = two_pi() * Exact(angle_q48) / Exact(turn_q48);
  const SineCosine got = sine_cosine(angle_q48);
  const Exact sine = Exact(got.sine_q48) / Exact(one_q48) - sin(x);
  const Exact cosine = Exact(got.cosine_q48) / Exact(one_q48) - cos(x);
  return static_cast<double>(std::max<Exact>(abs(sine), abs(cosine)));
}

TEST(Angle, SineAndCosineToFortyThreeBits) {
  std::mt19937_64 random(1);
  double worst = 0;
  for (int i = 0; i < test::scaled(1000); ++i)
    worst = std::max(worst, error_at(static_cast<std::int64_t>(random() >> 16)));
  // The entries of the table, and the middles between two of them, where the remainder is largest.
  for (std::int64_t place = 0; place < 512; ++place)
    for (const std::int64_t beside : {-1, 0, 1})
      worst = std::max(worst, error_at((place << 39) + beside));
  RecordProperty("worst_log2", std::to_string(std::log2(worst)));
  EXPECT_LT(std::log2(worst), -43.5);
}

TEST(Angle, QuartersAreExact) {
  const std::int64_t one = one_q48;
  const std::int64_t want[4][2] = {{0, one}, {one, 0}, {0, -one}, {-one, 0}};
  for (int quarter = -8; quarter < 8; ++quarter) {
    const SineCosine got = sine_cosine(quarter * (turn_q48 / 4));
    EXPECT_EQ(got.sine_q48, want[quarter & 3][0]) << quarter;
    EXPECT_EQ(got.cosine_q48, want[quarter & 3][1]) << quarter;
  }
}

TEST(Angle, WholeTurnsAreZero) {
  std::mt19937_64 random(2);
  for (int i = 0; i < test::scaled(1000); ++i) {
    const auto angle = static_cast<std::int64_t>(random() >> 16);
    const auto turns = static_cast<std::int64_t>(random() % 20001) - 10000;
    const SineCosine a = sine_cosine(angle), b = sine_cosine(angle + turns * turn_q48);
    ASSERT_EQ(a.sine_q48, b.sine_q48);
    ASSERT_EQ(a.cosine_q48, b.cosine_q48);
  }
}

/// Error of angle_of(), in its units.
double angle_error(test::Native x, test::Native y) {
  const auto exact = [](test::Native v) {
    const bool negative = v < 0;
    const auto u = static_cast<test::UnsignedNative>(negative ? -v : v);
    const Exact size = Exact(static_cast<std::uint64_t>(u >> 64)) * pow(Exact(2), 64) +
                       Exact(static_cast<std::uint64_t>(u));
    return negative ? Exact(-size) : size;
  };
  Exact angle = atan2(exact(y), exact(x));
  if (angle < 0) angle += two_pi();
  const std::int64_t got = angle_of(test::to_int128(x), test::to_int128(y));
  EXPECT_GE(got, 0);
  EXPECT_LE(got, turn_q48);
  return static_cast<double>(abs(Exact(got) - angle / two_pi() * Exact(turn_q48)));
}

test::Native any_number(std::mt19937_64& random, int max_bits) {
  const auto wide = static_cast<test::UnsignedNative>(random()) << 64 | random();
  const auto v = static_cast<test::Native>(wide >> (128 - max_bits));
  return random() % 2 != 0 ? v : -v;
}

TEST(Angle, OfAnyVector) {
  std::mt19937_64 random(3);
  double worst = 0;
  for (int i = 0; i < test::scaled(1000); ++i) {
    const auto x = any_number(random, 1 + static_cast<int>(random() % 126));
    const auto y = any_number(random, 1 + static_cast<int>(random() % 126));
    if (x != 0 || y != 0) worst = std::max(worst, angle_error(x, y));
  }
  for (int i = 0; i < test::scaled(1000); ++i)  // components of about the same size
    worst = std::max(worst, angle_error(any_number(random, 96), any_number(random, 96)));
  RecordProperty("worst", std::to_string(worst));
  EXPECT_LT(worst, 2);
}

TEST(Angle, OfAxesAndDiagonals) {
  const std::int64_t eighth = turn_q48 / 8;
  EXPECT_EQ(angle_of(5, 0), 0);
  EXPECT_EQ(angle_of(5, 5), eighth);
  EXPECT_EQ(angle_of(0, 5), 2 * eighth);
  EXPECT_EQ(angle_of(-5, 5), 3 * eighth);
  EXPECT_EQ(angle_of(-5, 0), 4 * eighth);
  EXPECT_EQ(angle_of(-5, -5), 5 * eighth);
  EXPECT_EQ(angle_of(0, -5), 6 * eighth);
  EXPECT_EQ(angle_of(5, -5), 7 * eighth);
  EXPECT_EQ(angle_of(0, 0), 0);
}

TEST(Angle, InvertsSineAndCosine) {
  std::mt19937_64 random(4);
  for (int i = 0; i < test::scaled(1000); ++i) {
    const auto angle = static_cast<std::int64_t>(random() >> 16);
    const SineCosine at = sine_cosine(angle);
    // 2^-43.5 rad is 3.6 units.
    ASSERT_LE(std::abs(angle_of(at.cosine_q48, at.sine_q48) - angle), 5) << angle;
  }
}

}  // namespace
}  // namespace lamplock::program::angle_test
