#include "firmware/program/curves/curve.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <type_traits>
#include <vector>

#include "tests/program/curve_checks.hpp"
#include "tests/scale.hpp"

namespace lamplock::program::curve_test {
namespace {

const ArcRequest arc{{mm(10), 0, 0, 0}, {0, mm(10), mm(1), 0}, {}, plane_xy, false, 0, mm(0.002)};
const SplineRequest spline{
    {}, {mm(10), 0, 0, 0}, {mm(10), mm(5), 0, 0}, {mm(3), mm(5)}, CurvePlane{plane_xy}, mm(0.002)};

TEST(Curve, IsSmallAndCanBeCopied) {
  EXPECT_LE(sizeof(Curve), 300u);
  EXPECT_TRUE(std::is_trivially_copyable_v<Curve>);
}

TEST(Curve, BeginsInactive) {
  Curve curve;
  EXPECT_FALSE(curve.active());
  EXPECT_EQ(curve.pieces(), 0u);
  EXPECT_EQ(curve.length_e7(), 0);
  Place at{1, 2, 3, 4};
  EXPECT_FALSE(curve.next(at));
  EXPECT_EQ(at, (Place{1, 2, 3, 4}));
}

TEST(Curve, IsActiveUntilItsLastPiece) {
  Curve curve;
  curve.begin_arc(arc);
  Place at{};
  for (std::uint32_t i = 0; i < curve.pieces(); ++i) {
    ASSERT_TRUE(curve.active());
    ASSERT_TRUE(curve.next(at));
  }
  EXPECT_FALSE(curve.active());
  EXPECT_EQ(at, arc.end);
  EXPECT_FALSE(curve.next(at));
  EXPECT_EQ(at, arc.end);
}

TEST(Curve, ANewCurveReplacesTheRemainingOne) {
  Curve fresh;
  fresh.begin_spline(spline);
  const std::vector<Place> want = trace(fresh, spline.start);
  Curve curve;
  curve.begin_arc(arc);
  Place at{};
  ASSERT_TRUE(curve.next(at));
  curve.begin_spline(spline);
  EXPECT_EQ(trace(curve, spline.start), want);
  curve.begin_arc(arc);
  EXPECT_EQ(trace(curve, arc.start).back(), arc.end);
}

TEST(Curve, CanBeStopped) {
  Curve curve;
  curve.begin_arc(arc);
  curve.stop();
  Place at{};
  EXPECT_FALSE(curve.active());
  EXPECT_FALSE(curve.next(at));
}

TEST(Curve, ACopyContinuesIndependently) {
  Curve curve;
  curve.begin_arc(arc);
  Place at{};
  ASSERT_TRUE(curve.next(at));
  Curve copy = curve;
  const std::vector<Place> rest = trace_rest(curve);
  EXPECT_EQ(trace_rest(copy), rest);
}

/// Start, end and steps of walks: small, large, negative.
TEST(IntegerDivider, IsExactForAnyNumberOfSteps) {
  std::mt19937_64 random(1);
  for (int i = 0; i < lamplock::test::scaled(300); ++i) {
    const auto steps = static_cast<std::uint32_t>(random() % 5000 + 1);
    const auto from = static_cast<std::int64_t>(random()) >> (2 + random() % 60);
    const auto to = static_cast<std::int64_t>(random()) >> (2 + random() % 60);
    IntegerDivider walk;
    walk.begin(from, to, steps);
    ASSERT_EQ(walk.value(), from);
    for (std::uint32_t k = 1; k <= steps; ++k) {
      const long double exact =
          static_cast<long double>(from) + static_cast<long double>(to - from) * k / steps;
      ASSERT_LE(std::abs(static_cast<long double>(walk.next(steps)) - exact), 0.75L);
    }
    ASSERT_EQ(walk.value(), to);
  }
}

TEST(IntegerDivider, RoundsToNearest) {
  IntegerDivider walk;
  walk.begin(0, -1, 4);
  EXPECT_EQ(walk.next(4), 0);
  EXPECT_EQ(walk.next(4), 0);  // a half, rounded up
  EXPECT_EQ(walk.next(4), -1);
  EXPECT_EQ(walk.next(4), -1);
}

TEST(IntegerDivider, ManyStepsOfALongDistance) {
  constexpr std::uint32_t steps = 2'000'000'011;
  IntegerDivider walk;
  walk.begin(-one_q62 / 2, one_q62 / 2, steps);
  for (std::uint32_t k = 1; k <= 1'000'000; ++k) walk.next(steps);
  const long double exact = -0x1p61L + 0x1p62L * 1e6L / steps;
  EXPECT_LE(std::abs(static_cast<long double>(walk.value()) - exact), 1);
}

}  // namespace
}  // namespace lamplock::program::curve_test
