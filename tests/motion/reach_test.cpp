// Both widths of reach() compared with the definition, by bisection in long double.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <string>
#include <type_traits>

#include "tests/motion/reach_question.hpp"
#include "tests/scale.hpp"

namespace lamplock::motion::reach_test {
namespace {

using test::hair;
using test::Question;
using test::random_question;
using Real = long double;

constexpr Real unit = 4294967296.0L;  // 2^32
Real real(std::int64_t q32) { return static_cast<Real>(q32) / unit; }

/// Furthest distance from speed a to b in time t: accelerate, cruise at the limit, brake.
Real furthest(Real a, Real b, Real t, Real limit) {
  const Real peak = std::min((a + b + t) / 2, limit);
  const Real up = peak - a, down = peak - b;
  return (a + peak) / 2 * up + (b + peak) / 2 * down + peak * (t - up - down);
}
Real nearest(Real a, Real b, Real t, Real limit) { return -furthest(-a, -b, t, limit); }

/// True if an end speed can be reached from start speed v.
bool can_start(Real v, Real q, Real t, Real limit) {
  return furthest(v, std::min(v + t, limit), t, limit) >= q &&
         nearest(v, std::max(v - t, -limit), t, limit) <= q;
}

/// Largest end speed from a start speed that can start.
Real max_end(Real v, Real q, Real t, Real limit) {
  Real lo = std::max(v - t, -limit), hi = std::min(v + t, limit);
  if (nearest(v, hi, t, limit) <= q) return hi;
  for (int i = 0; i < 80; ++i) {
    const Real middle = (lo + hi) / 2;
    (nearest(v, middle, t, limit) <= q ? lo : hi) = middle;
  }
  return lo;
}
Real min_end(Real v, Real q, Real t, Real limit) { return -max_end(-v, -q, t, limit); }

struct Truth {
  Real lo, hi;
};

/// The interval of end speeds from many start speeds: both ends of the possible ones (by bisection
/// from a possible one) and some between.
std::optional<Truth> truth(Real a, Real b, Real q, Real t, Real limit) {
  constexpr int samples = 64;
  const auto can = [&](Real v) { return can_start(v, q, t, limit); };
  const auto edge = [&](Real inside, Real outside) {
    for (int i = 0; i < 80; ++i) {
      const Real middle = (inside + outside) / 2;
      (can(middle) ? inside : outside) = middle;
    }
    return inside;
  };
  std::optional<Real> first, last;
  for (int i = 0; i <= samples; ++i) {
    const Real v = a + (b - a) * i / samples;
    if (!can(v)) continue;
    if (!first) first = i == 0 ? v : edge(v, a + (b - a) * (i - 1) / samples);
    last = i == samples ? v : edge(v, a + (b - a) * (i + 1) / samples);
  }
  if (!first) return std::nullopt;
  Truth result{limit, -limit};
  for (int i = 0; i <= samples; ++i) {
    const Real v = *first + (*last - *first) * i / samples;
    result.lo = std::min(result.lo, min_end(v, q, t, limit));
    result.hi = std::max(result.hi, max_end(v, q, t, limit));
  }
  return result;
}

template <class Width>
void expect_truth(const Question& ask) {
  const auto got = Width::reach(ask);
  const auto want = truth(real(ask.from.lo_q32), real(ask.from.hi_q32), real(ask.q_q32), ask.beats,
                          real(ask.limit_q32()));
  if (got) {
    // Never larger than the truth, except for a unit or two of the last place due to long double.
    ASSERT_TRUE(want.has_value()) << ask;
    const Real slack = 2 / unit * (1 + ask.beats * 1e-9L);
    ASSERT_GE(real(got->lo_q32), want->lo - slack) << ask;
    ASSERT_LE(real(got->hi_q32), want->hi + slack) << ask;
    ASSERT_LE(real(got->lo_q32), want->lo + hair<Width>(ask)) << ask;
    ASSERT_GE(real(got->hi_q32), want->hi - hair<Width>(ask)) << ask;
  } else if (want) {
    ASSERT_LE(want->hi - want->lo, hair<Width>(ask)) << ask;
  }
}

template <class Width>
class Reach : public testing::Test {};
struct Names {
  template <class Width>
  static std::string GetName(int) {  // NOLINT(readability-identifier-naming): googletest's name
    return std::is_same_v<Width, test::Wide> ? "64" : "32";
  }
};
using Widths = testing::Types<test::Wide, test::Scaled>;
TYPED_TEST_SUITE(Reach, Widths, Names);

TYPED_TEST(Reach, IsTheExactProjectionForShortTimes) {
  std::mt19937_64 random(11);
  for (int i = 0; i < test::scaled(2'000); ++i)
    ASSERT_NO_FATAL_FAILURE(expect_truth<TypeParam>(random_question(random, 8)));
}

TYPED_TEST(Reach, IsTheExactProjectionForKilohertzLamps) {
  std::mt19937_64 random(12);
  for (int i = 0; i < test::scaled(2'000); ++i)
    ASSERT_NO_FATAL_FAILURE(expect_truth<TypeParam>(random_question(random, 4000)));
}

TYPED_TEST(Reach, HasBothAnswersOften) {
  // The questions above would be useless if nearly all had the same answer.
  for (const int longest : {8, 4000}) {
    std::mt19937_64 random(11);
    int can = 0;
    for (int i = 0; i < 1000; ++i)
      can += TypeParam::reach(random_question(random, longest)) ? 1 : 0;
    EXPECT_GT(can, 300);
    EXPECT_LT(can, 950);
  }
}

TYPED_TEST(Reach, MirrorsWithTheDisplacement) {
  std::mt19937_64 random(13);
  for (int i = 0; i < test::scaled(50'000); ++i) {
    const Question ask = random_question(random, 8000);
    const auto to = TypeParam::reach(ask), mirrored = TypeParam::reach(ask.mirrored());
    ASSERT_EQ(to.has_value(), mirrored.has_value()) << ask;
    if (!to) continue;
    ASSERT_EQ(mirrored->lo_q32, -to->hi_q32) << ask;
    ASSERT_EQ(mirrored->hi_q32, -to->lo_q32) << ask;
  }
}

TYPED_TEST(Reach, AnswersTheSameBackwards) {
  // From every reachable speed, the backward answer leads into the start interval.
  std::mt19937_64 random(14);
  int tried = 0;
  for (int i = 0; i < test::scaled(20'000); ++i) {
    Question ask = random_question(random, 50);
    const auto to = TypeParam::reach(ask);
    const std::int64_t unit_q32 = ask.axis.q32(1);
    if (!to || to->hi_q32 - to->lo_q32 < 1000 * unit_q32) continue;
    const SpeedInterval from = ask.from;
    const std::int64_t middle = (to->lo_q32 + to->hi_q32) / 2 / unit_q32 * unit_q32;
    ask.from = {middle, middle};
    const auto back = TypeParam::reach(ask);
    ASSERT_TRUE(back.has_value()) << ask;
    const auto slack = static_cast<std::int64_t>(std::ldexp(hair<TypeParam>(ask), 32));
    ASSERT_LE(back->lo_q32, from.hi_q32 + slack) << ask;
    ASSERT_GE(back->hi_q32, from.lo_q32 - slack) << ask;
    ++tried;
  }
  EXPECT_GT(tried, test::scaled(20'000) / 4);
}

TYPED_TEST(Reach, AWiderStartReachesMore) {
  std::mt19937_64 random(15);
  for (int i = 0; i < test::scaled(20'000); ++i) {
    Question ask = random_question(random, 100);
    const auto to = TypeParam::reach(ask);
    if (!to) continue;
    const std::int64_t unit_q32 = ask.axis.q32(1);
    const auto wider = static_cast<std::int64_t>(random() % (std::uint64_t{1} << 33));
    const std::int64_t whole = wider / unit_q32 * unit_q32;
    ask.from = {std::max(ask.from.lo_q32 - whole, -ask.limit_q32()),
                std::min(ask.from.hi_q32 + whole, ask.limit_q32())};
    const auto more = TypeParam::reach(ask);
    ASSERT_TRUE(more.has_value()) << ask;
    const auto slack = static_cast<std::int64_t>(std::ldexp(hair<TypeParam>(ask), 32));
    ASSERT_LE(more->lo_q32, to->lo_q32 + slack) << ask;
    ASSERT_GE(more->hi_q32, to->hi_q32 - slack) << ask;
  }
}

}  // namespace
}  // namespace lamplock::motion::reach_test
