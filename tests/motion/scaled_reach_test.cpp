// Special properties of reach() in 32 bits: its distance from the 64-bit version (both are compared
// with the definition in reach_test.cpp), and its parts.
#include "firmware/motion/profile/scaled_reach.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/motion/reach_question.hpp"
#include "tests/scale.hpp"

namespace lamplock::motion::scaled_reach_test {
namespace {

using test::Question;
using test::random_question;
using test::Scaled;

constexpr int longest = 8000;

TEST(ScaledReach, IsInsideTheExactAnswerAndCloseToIt) {
  std::mt19937_64 random(21);
  int can = 0;
  for (int i = 0; i < test::scaled(200'000); ++i) {
    const Question ask = random_question(random, longest);
    const auto got = Scaled::reach(ask), want = test::Wide::reach(ask);
    if (got) {
      ++can;
      ASSERT_TRUE(want.has_value()) << ask;
      // The exact one is rounded inwards too, by some units of 2^-32.
      ASSERT_GE(got->lo_q32, want->lo_q32 - 64) << ask;
      ASSERT_LE(got->hi_q32, want->hi_q32 + 64) << ask;
    }
    const auto width = [](const auto& to) {
      return to ? std::ldexp(static_cast<double>(to->hi_q32 - to->lo_q32), -32) : 0;
    };
    const double tolerance = test::hair<Scaled>(ask);
    ASSERT_GE(width(got), width(want) - (got ? 2 * tolerance : tolerance)) << ask;
  }
  EXPECT_GT(can, test::scaled(200'000) / 3);
  EXPECT_LT(can, test::scaled(200'000) * 99 / 100);
}

TEST(ScaledReach, NoReachableAnswerIsRuledOut) {
  std::mt19937_64 random(23);
  int ruled_out = 0;
  for (int i = 0; i < test::scaled(100'000); ++i) {
    const Question ask = random_question(random, longest);
    const auto reached = Scaled::reach(ask);
    const std::int32_t limit = ask.axis.limit_qs;
    SpeedRange to{static_cast<std::int32_t>(random() % static_cast<std::uint32_t>(limit)), 0};
    if (random() % 2 == 0) to.lo_qs = -to.lo_qs;
    to.hi_qs = to.lo_qs + static_cast<std::int32_t>(random() % 1000);
    const bool joins = reached && ask.axis.q32(to.lo_qs) <= reached->hi_q32 &&
                       reached->lo_q32 <= ask.axis.q32(to.hi_qs);
    const bool may = can_join(ask.axis, ask.scaled_from(), to, ask.way_qs(), ask.beats);
    ASSERT_TRUE(may || !joins);
    ruled_out += may ? 0 : 1;
  }
  EXPECT_GT(ruled_out, test::scaled(100'000) / 5);
}

TEST(ScaledReach, TheMeanSpeedIsBetweenItsNeighbours) {
  std::mt19937_64 random(24);
  for (int i = 0; i < test::scaled(100'000); ++i) {
    const auto beats = static_cast<std::int32_t>(1 + random() % 8000);
    const auto way = static_cast<std::int64_t>(random()) >> (random() % 40 + 20);
    if (std::abs(way / beats) >= 1 << 28) continue;
    const MeanSpeed mean = mean_speed(way, beats);
    ASSERT_LE(std::int64_t{mean.down_qs} * beats, way);
    if (way != 0) {
      ASSERT_GE(std::int64_t{mean.up_qs} * beats, way + 1) << way << " in " << beats;
    }
    ASSERT_LE(mean.up_qs - mean.down_qs, 1);
  }
}

// Random moves rarely come this close to the ends of 32 bits.
TEST(ScaledReach, TheMeanSpeedIsContinuousWhere32BitsEnd) {
  for (const std::int64_t end : {std::int64_t{-1} << 31, (std::int64_t{1} << 31) - 1})
    for (std::int64_t way = end - 9000; way <= end + 9000; ++way)
      for (const std::int32_t beats : {16, 17, 500, 8192}) {
        const MeanSpeed mean = mean_speed(way, beats);
        ASSERT_LE(std::int64_t{mean.down_qs} * beats, way);
        ASSERT_GT(std::int64_t{mean.up_qs} * beats, way);
        ASSERT_EQ(mean.up_qs, mean.down_qs + 1);
      }
}

TEST(ScaledReach, RootsAreNeverTooLarge) {
  std::mt19937_64 random(25);
  for (int i = 0; i < test::scaled(200'000); ++i) {
    std::uint64_t x = random() >> (random() % 64);
    if (random() % 4 == 0)
      x = wide_product(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(x));
    ASSERT_LE(nearly_isqrt(x), isqrt(x)) << x;
    ASSERT_GE(nearly_isqrt(x) + std::uint64_t{4}, isqrt(x)) << x;
    const auto n = static_cast<std::uint32_t>((1u << 28) + random() % (3u << 28));
    const std::uint32_t exact = isqrt(std::uint64_t{n} << 32), root = root_of_upper_half(n);
    ASSERT_GE(root, exact) << n;
    ASSERT_LE(root, exact + 2) << n;
  }
}

}  // namespace
}  // namespace lamplock::motion::scaled_reach_test
