// reach() against the definition of what it computes, by bisection in long double.
#include "firmware/motion/reach.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "tests/scale.hpp"

namespace lamplock::motion {
namespace {

using Real = long double;

constexpr Real unit = 4294967296.0L;  // 2^32
Real real(std::int64_t q32) { return static_cast<Real>(q32) / unit; }
std::int64_t q32(Real x) { return static_cast<std::int64_t>(std::floor(x * unit)); }

/// Furthest that a motion from a to b in t gets: up to the limit, stay there, down.
Real furthest(Real a, Real b, Real t, Real limit) {
  const Real peak = std::min((a + b + t) / 2, limit);
  const Real up = peak - a, down = peak - b;
  return (a + peak) / 2 * up + (b + peak) / 2 * down + peak * (t - up - down);
}
Real nearest(Real a, Real b, Real t, Real limit) { return -furthest(-a, -b, t, limit); }

/// True if some end speed can be had from start speed v.
bool can_start(Real v, Real q, Real t, Real limit) {
  return furthest(v, std::min(v + t, limit), t, limit) >= q &&
         nearest(v, std::max(v - t, -limit), t, limit) <= q;
}

/// Largest end speed from a start speed that can start.
Real largest_end(Real v, Real q, Real t, Real limit) {
  Real lo = std::max(v - t, -limit), hi = std::min(v + t, limit);
  if (nearest(v, hi, t, limit) <= q) return hi;
  for (int i = 0; i < 80; ++i) {
    const Real middle = (lo + hi) / 2;
    (nearest(v, middle, t, limit) <= q ? lo : hi) = middle;
  }
  return lo;
}
Real smallest_end(Real v, Real q, Real t, Real limit) { return -largest_end(-v, -q, t, limit); }

struct Truth {
  Real lo, hi;
};

/// The interval of end speeds by looking at many start speeds: both ends of those that can start
/// (by bisection from one that can) and some between.
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
    result.lo = std::min(result.lo, smallest_end(v, q, t, limit));
    result.hi = std::max(result.hi, largest_end(v, q, t, limit));
  }
  return result;
}

/// A question to reach().
struct Question {
  SpeedInterval from;
  std::int64_t q = 0;
  std::int32_t beats = 1;
  std::int64_t limit = 0;
};

Question random_question(std::mt19937_64& random, int longest) {
  std::uniform_real_distribution<double> around(-1, 1);
  Question ask;
  ask.beats = 1 + static_cast<std::int32_t>(std::pow(longest, std::fabs(around(random)))) % longest;
  const Real t = ask.beats;
  const Real limit = std::pow(10.0L, 1.5L * around(random)) * t;
  Real a = around(random) * std::min(limit, 2 * t), b = around(random) * std::min(limit, 2 * t);
  if (a > b) std::swap(a, b);
  if (random() % 3 == 0) b = a;
  if (random() % 5 == 0) a = b = 0;
  // Displacements near what the middle of the interval covers, so that most can be reached.
  const Real q = std::clamp((a + b) / 2 * t + around(random) * t * t / 2, -limit * t, limit * t);
  ask.from = {q32(a), q32(b)};
  ask.q = q32(q);
  ask.limit = q32(limit);
  return ask;
}

/// Rounding inwards by one unit next to a vertical tangent moves a root by up to root(2^-32 t).
Real hair(const Question& ask) {
  return 4 * std::sqrt(static_cast<Real>(ask.beats) * (ask.beats + real(ask.limit)) / unit);
}

void expect_truth(const Question& ask) {
  SpeedInterval got;
  const bool can = reach(ask.from, ask.q, ask.beats, ask.limit, got);
  const auto want =
      truth(real(ask.from.lo_q32), real(ask.from.hi_q32), real(ask.q), ask.beats, real(ask.limit));
  const auto text = [&] {
    return testing::Message() << "from [" << ask.from.lo_q32 << ", " << ask.from.hi_q32 << "] q "
                              << ask.q << " beats " << ask.beats << " limit " << ask.limit;
  };
  if (can) {
    // Never larger than the truth: a unit or two of the last place is what the long double costs.
    ASSERT_TRUE(want.has_value()) << text();
    const Real slack = 2 / unit * (1 + ask.beats * 1e-9L);
    ASSERT_GE(real(got.lo_q32), want->lo - slack) << text();
    ASSERT_LE(real(got.hi_q32), want->hi + slack) << text();
    ASSERT_LE(real(got.lo_q32), want->lo + hair(ask)) << text();
    ASSERT_GE(real(got.hi_q32), want->hi - hair(ask)) << text();
  } else if (want) {
    ASSERT_LE(want->hi - want->lo, hair(ask)) << text();
  }
}

TEST(Reach, IsTheExactProjectionForShortTimes) {
  std::mt19937_64 random(11);
  for (int i = 0; i < test::scaled(2'000); ++i) expect_truth(random_question(random, 8));
}

TEST(Reach, IsTheExactProjectionForKilohertzLamps) {
  std::mt19937_64 random(12);
  for (int i = 0; i < test::scaled(2'000); ++i) expect_truth(random_question(random, 4000));
}

TEST(Reach, AnswersBothWaysOften) {
  // The questions above would be worthless if nearly all had the same answer.
  std::mt19937_64 random(11);
  int can = 0;
  SpeedInterval to;
  for (int i = 0; i < 1000; ++i) {
    const Question ask = random_question(random, 8);
    can += reach(ask.from, ask.q, ask.beats, ask.limit, to) ? 1 : 0;
  }
  EXPECT_GT(can, 300);
  EXPECT_LT(can, 950);
}

TEST(Reach, MirrorsWithTheDisplacement) {
  std::mt19937_64 random(13);
  for (int i = 0; i < test::scaled(20'000); ++i) {
    const Question ask = random_question(random, 100);
    SpeedInterval to, mirrored;
    const bool can = reach(ask.from, ask.q, ask.beats, ask.limit, to);
    ASSERT_EQ(can,
              reach({-ask.from.hi_q32, -ask.from.lo_q32}, -ask.q, ask.beats, ask.limit, mirrored));
    if (!can) continue;
    ASSERT_EQ(mirrored.lo_q32, -to.hi_q32);
    ASSERT_EQ(mirrored.hi_q32, -to.lo_q32);
  }
}

TEST(Reach, AnswersTheSameBackwards) {
  // From every speed that can be reached, the backward answer leads into the start interval.
  std::mt19937_64 random(14);
  int tried = 0;
  for (int i = 0; i < test::scaled(20'000); ++i) {
    const Question ask = random_question(random, 50);
    SpeedInterval to, back;
    if (!reach(ask.from, ask.q, ask.beats, ask.limit, to)) continue;
    const std::int64_t middle = to.lo_q32 + (to.hi_q32 - to.lo_q32) / 2;
    if (to.hi_q32 - to.lo_q32 < 1000) continue;
    ASSERT_TRUE(reach({middle, middle}, ask.q, ask.beats, ask.limit, back));
    const auto slack = static_cast<std::int64_t>(hair(ask) * unit);
    ASSERT_LE(back.lo_q32, ask.from.hi_q32 + slack);
    ASSERT_GE(back.hi_q32, ask.from.lo_q32 - slack);
    ++tried;
  }
  EXPECT_GT(tried, test::scaled(20'000) / 4);
}

TEST(Reach, ReachesMoreFromMore) {
  std::mt19937_64 random(15);
  for (int i = 0; i < test::scaled(20'000); ++i) {
    const Question ask = random_question(random, 100);
    SpeedInterval to, more;
    if (!reach(ask.from, ask.q, ask.beats, ask.limit, to)) continue;
    const auto wider = static_cast<std::int64_t>(random() % (std::uint64_t{1} << 33));
    const SpeedInterval from{std::max(ask.from.lo_q32 - wider, -ask.limit),
                             std::min(ask.from.hi_q32 + wider, ask.limit)};
    ASSERT_TRUE(reach(from, ask.q, ask.beats, ask.limit, more));
    const auto slack = static_cast<std::int64_t>(hair(ask) * unit);
    ASSERT_LE(more.lo_q32, to.lo_q32 + slack);
    ASSERT_GE(more.hi_q32, to.hi_q32 - slack);
  }
}

}  // namespace
}  // namespace lamplock::motion
