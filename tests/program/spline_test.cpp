#include "firmware/program/curves/spline.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "tests/program/curve_checks.hpp"
#include "tests/scale.hpp"

namespace lamplock::program::spline_test {
namespace {

constexpr long double point_error = 1;  // spline.hpp; 10^-5 mm is 100

struct TrueSpline {
  std::array<Point, 4> p;

  explicit TrueSpline(const SplineRequest& r)
      : p{in_plane(r.start, r.plane), in_plane(r.first_control, r.plane),
          in_plane(r.second_control, r.plane), in_plane(r.end, r.plane)} {}
  Point operator()(long double t) const {
    const long double s = 1 - t;
    const std::array<long double, 4> w{s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t};
    Point sum{};
    for (std::size_t i = 0; i < 4; ++i) sum = {sum.x + w[i] * p[i].x, sum.y + w[i] * p[i].y};
    return sum;
  }
  /// Length by so many chords that cusps do not matter.
  long double length_with(long double other, int chords = 20000) const {
    long double sum = 0;
    Point last = p[0];
    for (int i = 1; i <= chords; ++i) {
      const Point next = (*this)(static_cast<long double>(i) / chords);
      sum += std::hypot(length(next - last), other / chords);
      last = next;
    }
    return sum;
  }
};

SplineRequest in_xy(std::array<double, 8> points_mm, double tolerance_mm = 0.002) {
  const auto at = [&](std::size_t i) {
    return Place{mm(points_mm[2 * i]), mm(points_mm[2 * i + 1]), 0, 0};
  };
  return {at(0), at(1), at(2), at(3), plane_xy, mm(tolerance_mm)};
}

Errors run(const SplineRequest& r, Curve& curve) {
  curve.begin_spline(r);
  const std::vector<Place> places = trace(curve, r.start);
  EXPECT_EQ(places.back(), r.end);
  return errors_of(places, r.plane, TrueSpline(r));
}

void expect_length(const Curve& curve, const SplineRequest& r) {
  const long double want = TrueSpline(r).length_with(other_way(r.start, r.end, r.plane));
  EXPECT_NEAR(static_cast<double>(curve.length_e7()), static_cast<double>(want),
              static_cast<double>(want / 1000 + 5));
}

SplineRequest any_spline(std::mt19937_64& random) {
  const auto part = [&] { return static_cast<double>(random() >> 11) / 0x1p53; };
  const std::array<CurvePlane, 3> planes{plane_xy, plane_zx, plane_yz};
  SplineRequest r{};
  r.plane = planes[random() % 3];
  const double size = 1e4 * std::pow(1e6, part());
  const auto place = [&](Place& p) {
    for (std::int64_t& axis : p) axis = std::llround(size * (2 * part() - 1));
  };
  for (Place* p : {&r.start, &r.first_control, &r.second_control, &r.end}) place(*p);
  if (random() % 4 == 0) r.first_control = r.start;
  if (random() % 4 == 0) r.second_control = r.end;
  if (random() % 8 == 0) r.end = r.start;
  r.tolerance_e7 = std::llround(1e2 * std::pow(1e4, part())) + std::llround(size * 1e-6);
  return r;
}

TEST(Spline, EveryPointIsOnTheCurveAndEveryChordKeepsTheTolerance) {
  std::mt19937_64 random(1);
  long double worst = 0;
  for (int i = 0; i < lamplock::test::scaled(500); ++i) {
    const SplineRequest r = any_spline(random);
    SCOPED_TRACE(i);
    Curve curve;
    const Errors errors = run(r, curve);
    worst = std::max(worst, errors.point);
    ASSERT_LE(errors.point, point_error);
    ASSERT_LE(errors.chord, static_cast<long double>(r.tolerance_e7) + 2);
    ASSERT_LE(errors.other, 0.51L);
  }
  RecordProperty("worst_e7", std::to_string(worst));
}

TEST(Spline, LengthWithinAThousandth) {
  std::mt19937_64 random(2);
  double worst = 0;
  for (int i = 0; i < lamplock::test::scaled(200); ++i) {
    SplineRequest r = any_spline(random);
    // Also without motion of other axes, and on a straight line with reversals.
    if (i % 3 != 0) r.end[r.plane.normal] = r.start[r.plane.normal];
    if (i % 3 != 0) r.end[3] = r.start[3];
    if (i % 3 == 2) {
      for (Place* p : {&r.start, &r.first_control, &r.second_control, &r.end})
        (*p)[r.plane.second] = (*p)[r.plane.first] / 2;
    }
    Curve curve;
    curve.begin_spline(r);
    const auto want =
        static_cast<double>(TrueSpline(r).length_with(other_way(r.start, r.end, r.plane), 5000));
    const double off = std::abs(static_cast<double>(curve.length_e7()) - want);
    ASSERT_LE(off, want / 1000 + 5) << i;
    if (want > 1e6) worst = std::max(worst, off / want);
  }
  RecordProperty("worst", std::to_string(worst));
}

TEST(Spline, NearlyAQuarterOfACircle) {
  // 4/3 (sqrt 2 - 1): a circle of 10 mm to within 0.03 %.
  const double k = 10 * 0.5522847498;
  const SplineRequest r = in_xy({10, 0, 10, k, k, 10, 0, 10});
  Curve curve;
  const Errors errors = run(r, curve);
  EXPECT_LE(errors.point, point_error);
  EXPECT_LE(errors.chord, mm(0.002));
  EXPECT_GT(errors.chord, mm(0.001));
  // M = 10 hypot(1 - 2 k + 0, k ...) of the control points: n = sqrt(3/4 M / e).
  const double second = std::hypot(10 - 2 * 10 + k, 0 - 2 * k + 10);
  EXPECT_EQ(curve.pieces(), static_cast<std::uint32_t>(std::ceil(std::sqrt(375 * second))));
  expect_length(curve, r);
}

TEST(Spline, StraightAndEvenIsOnePiece) {
  const SplineRequest r = in_xy({0, 0, 10, 20, 20, 40, 30, 60});
  Curve curve;
  EXPECT_LE(run(r, curve).chord, 1);
  EXPECT_EQ(curve.pieces(), 1u);
  expect_length(curve, r);
}

TEST(Spline, DegenerateSplinesTerminate) {
  const std::vector<std::array<double, 8>> all{
      {5, 5, 5, 5, 5, 5, 5, 5},           // a point
      {0, 0, 0, 0, 10, 10, 10, 10},       // a line, controls at its ends
      {0, 0, 10, 0, 10, 0, 0, 0},         // to and fro
      {0, 0, 30, 0, -20, 0, 10, 0},       // a line with two reversals
      {0, 0, 10, 10, 0, 10, 10, 0},       // a cusp
      {0, 0, 20, 10, -10, 10, 10, 0},     // a loop
      {0, 0, 1e4, 1e4, -1e4, 1e4, 0, 0},  // closed, large
      {0, 0, 0, 0, 0, 0, 0.0000001, 0},   // the shortest distance
      {-1e4, -1e4, 1e4, 1e4, -1e4, 1e4, 1e4, -1e4},
  };
  for (const auto& points : all) {
    const SplineRequest r = in_xy(points);
    SCOPED_TRACE(&points - all.data());
    Curve curve;
    const Errors errors = run(r, curve);
    EXPECT_LE(errors.point, point_error);
    EXPECT_LE(errors.chord, mm(0.002) + 2);
    EXPECT_LE(curve.pieces(), 10000u);
    expect_length(curve, r);
  }
}

TEST(Spline, AnyToleranceTerminates) {
  SplineRequest r = in_xy({-1e4, -1e4, 1e4, 1e4, -1e4, 1e4, 1e4, -1e4});
  Curve curve;
  for (const std::int64_t tolerance :
       {std::int64_t{0}, std::int64_t{-5}, std::numeric_limits<std::int64_t>::min()}) {
    r.tolerance_e7 = tolerance;
    const Errors errors = run(r, curve);
    EXPECT_EQ(curve.pieces(), max_spline_pieces);
    EXPECT_LE(errors.point, point_error);
    EXPECT_LE(errors.chord, 300);
  }
  r.tolerance_e7 = std::numeric_limits<std::int64_t>::max();
  EXPECT_LE(run(r, curve).point, point_error);
  EXPECT_EQ(curve.pieces(), 1u);
}

TEST(Spline, AtTheLimitsOfTheNumbers) {
  for (const std::int64_t most : {max_position_e7, max_coordinate_e7}) {
    for (int bits = 0; bits < 256; ++bits) {
      const auto at = [&](int bit) { return (bits >> bit & 1) != 0 ? most : -most; };
      const SplineRequest r{{at(0), at(1), -most, most},
                            {at(2), at(3), 0, 0},
                            {at(4), at(5), 0, 0},
                            {at(6), at(7), most, -most},
                            plane_xy,
                            most / 1000};
      Curve curve;
      ASSERT_LE(run(r, curve).point, 2);
    }
  }
}

TEST(Spline, OutsideTheNumbersIsAStraightPiece) {
  SplineRequest r = in_xy({0, 0, 1, 1, 2, 2, 3, 3});
  r.second_control[1] = max_coordinate_e7 + 1;
  Curve curve;
  curve.begin_spline(r);
  Place at{};
  EXPECT_TRUE(curve.next(at));
  EXPECT_EQ(at, r.end);
  EXPECT_FALSE(curve.next(at));
}

}  // namespace
}  // namespace lamplock::program::spline_test
