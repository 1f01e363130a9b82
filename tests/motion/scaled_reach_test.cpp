// reach() in 32 bits against reach() in 64, which is held against the definition (reach_test.cpp).
#include "firmware/motion/scaled_reach.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "firmware/motion/reach.hpp"
#include "tests/scale.hpp"

namespace lamplock::motion {
namespace {

constexpr double unit_q32 = 4294967296.0;

/// A question to both.
struct Question {
  AxisScale axis;
  std::int64_t limit_q32 = 0;
  SpeedRange from{};
  std::int64_t q_q32 = 0;
  std::int32_t beats = 1;

  double unit() const { return std::ldexp(1.0, -axis.bits); }
  std::int64_t way() const { return q_q32 >> (32 - axis.bits); }
  MeanSpeed mean() const { return mean_speed(way(), beats); }
  SpeedInterval wide() const { return {axis.q32(from.lo_qs), axis.q32(from.hi_qs)}; }
};

Question random_question(std::mt19937_64& random) {
  std::uniform_real_distribution<double> around(-1, 1), part(0, 1);
  Question ask;
  const double limit = std::pow(10.0, -1.5 + 4.5 * part(random));  // beats
  ask.limit_q32 = static_cast<std::int64_t>(limit * unit_q32);
  ask.axis = make_scale(ask.limit_q32);
  ask.limit_q32 = ask.axis.q32(ask.axis.limit_qs);
  const double longest = std::min(8000.0, 1 + 12 * limit);
  ask.beats = static_cast<std::int32_t>(std::pow(longest, part(random)));
  const double t = ask.beats;
  double a = around(random) * std::min(limit, 2 * t), b = around(random) * std::min(limit, 2 * t);
  if (a > b) std::swap(a, b);
  if (random() % 3 == 0) b = a;
  if (random() % 5 == 0) a = b = 0;
  ask.from = {ask.axis.scaled(static_cast<std::int64_t>(a * unit_q32)),
              ask.axis.scaled(static_cast<std::int64_t>(b * unit_q32))};
  const double q = (a + b) / 2 * t + around(random) * t * t / 2;
  ask.q_q32 = static_cast<std::int64_t>(std::clamp(q, -limit * t, limit * t) * unit_q32);
  return ask;
}

/// Rounding by some units next to a vertical tangent moves a root by up to the root of them.
double hair(const Question& ask) {
  const double limit = static_cast<double>(ask.limit_q32) / unit_q32;
  return 6 * std::sqrt(ask.beats * (ask.beats + limit) * ask.unit()) + 8 * ask.unit();
}

TEST(ScaledReach, LiesInsideTheExactAnswerAndCloseToIt) {
  std::mt19937_64 random(21);
  int can = 0;
  for (int i = 0; i < test::scaled(200'000); ++i) {
    const Question ask = random_question(random);
    SpeedRange got{};
    SpeedInterval want;
    const bool is = reach(ask.axis, ask.from, ask.mean(), ask.beats, got);
    const bool exact = reach(ask.wide(), ask.q_q32, ask.beats, ask.limit_q32, want);
    const auto text = [&] {
      return testing::Message() << "from [" << ask.from.lo_qs << ", " << ask.from.hi_qs << "] bits "
                                << ask.axis.bits << " q " << ask.q_q32 << " beats " << ask.beats
                                << " limit " << ask.axis.limit_qs;
    };
    if (is) {
      ++can;
      ASSERT_TRUE(exact) << text();
      // The exact one is rounded inwards too, by some units of 2^-32.
      ASSERT_GE(ask.axis.q32(got.lo_qs), want.lo_q32 - 64) << text();
      ASSERT_LE(ask.axis.q32(got.hi_qs), want.hi_q32 + 64) << text();
    }
    const double width = exact ? static_cast<double>(want.hi_q32 - want.lo_q32) / unit_q32 : 0;
    if (!is) {
      ASSERT_LE(width, hair(ask)) << text();
      continue;
    }
    const double got_width = (got.hi_qs - got.lo_qs) * ask.unit();
    ASSERT_GE(got_width, width - 2 * hair(ask)) << text();
  }
  EXPECT_GT(can, test::scaled(200'000) / 3);
  EXPECT_LT(can, test::scaled(200'000) * 99 / 100);
}

TEST(ScaledReach, MirrorsWithTheWay) {
  std::mt19937_64 random(22);
  for (int i = 0; i < test::scaled(50'000); ++i) {
    const Question ask = random_question(random);
    SpeedRange to{}, mirrored{};
    const MeanSpeed mean = ask.mean();
    const bool is = reach(ask.axis, ask.from, mean, ask.beats, to);
    ASSERT_EQ(is, reach(ask.axis, {-ask.from.hi_qs, -ask.from.lo_qs}, {-mean.up_qs, -mean.down_qs},
                        ask.beats, mirrored));
    if (!is) continue;
    ASSERT_EQ(mirrored.lo_qs, -to.hi_qs);
    ASSERT_EQ(mirrored.hi_qs, -to.lo_qs);
  }
}

TEST(ScaledReach, NothingIsRuledOutThatCanBeReached) {
  std::mt19937_64 random(23);
  int ruled_out = 0;
  for (int i = 0; i < test::scaled(100'000); ++i) {
    const Question ask = random_question(random);
    SpeedRange reached{};
    const bool is = reach(ask.axis, ask.from, ask.mean(), ask.beats, reached);
    const std::int32_t limit = ask.axis.limit_qs;
    SpeedRange to{static_cast<std::int32_t>(random() % static_cast<std::uint32_t>(limit)), 0};
    if (random() % 2 == 0) to.lo_qs = -to.lo_qs;
    to.hi_qs = to.lo_qs + static_cast<std::int32_t>(random() % 1000);
    const bool joins = is && to.lo_qs <= reached.hi_qs && reached.lo_qs <= to.hi_qs;
    const bool may = can_join(ask.axis, ask.from, to, ask.way(), ask.beats);
    ASSERT_TRUE(may || !joins);
    ruled_out += may ? 0 : 1;
  }
  EXPECT_GT(ruled_out, test::scaled(100'000) / 5);
}

TEST(ScaledReach, TheMeanSpeedLiesBetweenItsNeighbours) {
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

// Random ways hardly ever come so near to the ends of 32 bits.
TEST(ScaledReach, TheMeanSpeedHasNoSeamWhere32BitsEnd) {
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
}  // namespace lamplock::motion
