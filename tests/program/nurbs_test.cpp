// NURBS (G5.2, G5.3): lengths of known curves, chords against a reference in floating point, the
// block in the interpreter.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/program/cosine_curve.hpp"
#include "tests/program/curve_checks.hpp"
#include "tests/program/rig.hpp"

namespace lamplock::program::nurbs_test {
namespace {

using test::at;
using test::expect_rows;
using test::Rig;

struct Control {
  double x_mm, y_mm, weight;
};

NurbsPoints points_of(const std::vector<Control>& control, std::uint32_t order) {
  NurbsPoints points;
  points.count = static_cast<std::uint32_t>(control.size());
  points.order = order;
  for (std::size_t i = 0; i < control.size(); ++i)
    points.points[i] = {{std::llround(control[i].x_mm * 1e7), std::llround(control[i].y_mm * 1e7)},
                        static_cast<std::uint32_t>(std::llround(control[i].weight * 1e6))};
  return points;
}

/// Chords of a curve, with its start.
std::vector<Place> chords_of(const NurbsPoints& points, std::int64_t tolerance_e7,
                             std::int64_t* length_e7 = nullptr) {
  const auto place = [&](std::uint32_t i) {
    return Place{points.points[i].place.first_e7, points.points[i].place.second_e7, 0, 0};
  };
  Curve curve;
  curve.begin_nurbs({place(0), place(points.count - 1), &points, {0, 1, 2}, tolerance_e7});
  if (length_e7 != nullptr) *length_e7 = curve.length_e7();
  return trace(curve, place(0));
}

/// The curve by the basis functions of Cox and de Boor, t from 0 to 1.
Point reference(const NurbsPoints& points, long double t) {
  const int degree = static_cast<int>(points.order) - 1, count = static_cast<int>(points.count);
  const int spans = count - degree;
  const auto knot = [&](int i) {
    return static_cast<long double>(std::clamp(i - degree, 0, spans));
  };
  const long double u = t * spans;
  std::vector<long double> basis(static_cast<std::size_t>(count + degree), 0);
  const int span = std::min(static_cast<int>(u), spans - 1) + degree;
  basis[static_cast<std::size_t>(span)] = 1;
  for (int d = 1; d <= degree; ++d)
    for (int i = 0; i < count + degree - d; ++i) {
      const auto part = [&](long double above, long double below, int k) {
        return below == 0 ? 0 : above / below * basis[static_cast<std::size_t>(k)];
      };
      basis[static_cast<std::size_t>(i)] =
          part(u - knot(i), knot(i + d) - knot(i), i) +
          part(knot(i + d + 1) - u, knot(i + d + 1) - knot(i + 1), i + 1);
    }
  long double x = 0, y = 0, weight = 0;
  for (int i = 0; i < count; ++i) {
    const NurbsPoint& point = points.points[static_cast<std::size_t>(i)];
    const long double share = basis[static_cast<std::size_t>(i)] * point.weight_e6;
    x += share * static_cast<long double>(point.place.first_e7);
    y += share * static_cast<long double>(point.place.second_e7);
    weight += share;
  }
  return {x / weight, y / weight};
}

double chord_sum(const std::vector<Place>& places) {
  double sum = 0;
  for (std::size_t i = 1; i < places.size(); ++i)
    sum += std::hypot(static_cast<double>(places[i][0] - places[i - 1][0]),
                      static_cast<double>(places[i][1] - places[i - 1][1]));
  return sum / 1e7;
}

/// Arcs are rational curves: three points whose middle weight is the cosine of half the angle;
/// half a circle has four points, of order 4. The parabola y = h - k (x - b)^2 from 0 to 2 b has
/// the length (2 k b sqrt(1 + 4 k^2 b^2) + asinh(2 k b)) / (2 k).
TEST(Nurbs, LengthsOfKnownCurves) {
  constexpr double pi = std::numbers::pi;
  const double root = std::sqrt(0.75);
  const struct {
    std::vector<Control> control;
    std::uint32_t order;
    double length_mm;
  } rows[] = {
      {{{0, 0, 1}, {10, 10, 1}, {20, 0, 1}}, 3, 22.955871},
      {{{0, 0, 1}, {5, 5, 1}, {10, 0, 1}}, 3, 11.477936},
      {{{10, 0, 1}, {10, 10, std::sqrt(0.5)}, {0, 10, 1}}, 3, 5 * pi},
      {{{30, 0, 2}, {30, 30 / root / 2, 2 * root}, {15, 30 * root, 2}}, 3, 10 * pi},
      {{{8, 0, 1}, {8, 16, 1. / 3}, {-8, 16, 1. / 3}, {-8, 0, 1}}, 4, 8 * pi},
      {{{0, 0, 1}, {3, 4, 5}, {6, 8, 0.1}, {9, 12, 1}}, 4, 15},
      {{{0, 0, 1}, {3, 4, 2}, {3, 14, 1}, {4, 14, 1}}, 2, 16},
  };
  for (const auto& row : rows) {
    std::int64_t length_e7 = 0;
    const auto places = chords_of(points_of(row.control, row.order), 10'000, &length_e7);
    EXPECT_NEAR(chord_sum(places) / row.length_mm, 1, 1e-4) << row.length_mm;
    EXPECT_NEAR(static_cast<double>(length_e7) / 1e7 / row.length_mm, 1, 1e-4) << row.length_mm;
  }
}

RC_GTEST_PROP(Nurbs, ChordsAreWithinTheToleranceOfTheCurve, ()) {
  const auto order =
      *rc::gen::inRange<std::uint32_t>(NurbsPoints::min_order, NurbsPoints::max_order + 1);
  const auto count = *rc::gen::inRange<std::uint32_t>(order, NurbsPoints::capacity + 1);
  const std::int64_t tolerance_e7 = *rc::gen::element(5'000, 20'000, 500'000);
  std::vector<Control> control;
  for (std::uint32_t i = 0; i < count; ++i)
    control.push_back({*rc::gen::inRange(-50'000, 50'000) / 1e3,
                       *rc::gen::inRange(-50'000, 50'000) / 1e3,
                       *rc::gen::inRange(100, 5000) / 1e3});
  const NurbsPoints points = points_of(control, order);
  const auto places = chords_of(points, tolerance_e7);
  const auto errors =
      errors_of(places, {0, 1, 2}, [&](long double t) { return reference(points, t); });
  RC_ASSERT(errors.point < 100);  // 10 nm
  RC_ASSERT(errors.chord <= tolerance_e7);
}

/// The example of docs/architecture.md for those who add a curve.
TEST(Cosine, ChordsAreWithinTheToleranceOfTheCurve) {
  constexpr std::int64_t tolerance_e7 = 20'000;
  const test::CosineRequest request{at(1, 2), at(41, 22), {0, 1, 2}, tolerance_e7};
  test::Cosine shape;
  const Division division = shape.begin(request, 0);
  std::vector<Place> places{request.start};
  for (std::uint32_t i = 1; i < division.pieces; ++i) {
    const PlanePoint point = shape.next(division.pieces);
    places.push_back({point.first_e7, point.second_e7, 0, 0});
  }
  places.push_back(request.end);
  const auto errors = errors_of(places, request.plane, [](long double t) {
    return Point{1e7L + t * 40e7L,
                 2e7L + (1 - std::cos(std::numbers::pi_v<long double> * t)) * 10e7L};
  });
  EXPECT_LT(errors.point, 2);
  EXPECT_LE(errors.chord, tolerance_e7);
  EXPECT_GT(errors.chord, tolerance_e7 / 2);  // no more pieces than needed
  EXPECT_NEAR(static_cast<double>(division.length_e7) / 1e7, chord_sum(places), 1e-4);
}

TEST(Nurbs, BlocksOfAProgram) {
  expect_rows({
      {"F60|G5.2|X10 Y10|X20 Y0", ""},
      {"F60|G5.2 L2|X3 Y4|N9 X6 Y8 (end)|G5.3|G1 X7", "feed 60 to 7 8 0"},
      {"F60|G91|G5.2 L2|X3 Y4|X6 Y8|G5.3|G90 G1 X7", "feed 60 to 7 8 0"},
      {"F60|G5.2 P1 L2 X3 Y4|G5.3|G0 X1", "rapid to 1 4 0"},
      {"F60|G5.2 L2 X3 Y4|G5.3|X1", "31@1"},
      {"F60|G20 G10 L2 P1 X1|G5.2 L2 X3 Y4|G5.3|G0 X0", "rapid to 25.4 101.6 0"},
  });
  Rig rig;
  rig.run("F60");
  rig.run("G5.2 P1 L3");
  for (const char* line : {"X0 Y1 P1", "X2 Y1 P1", "X2 Y0 P1", "", "X0 Y0 P2"})
    EXPECT_EQ(rig.run(line), "");
  EXPECT_EQ(rig.machine(), at(0, 0));
  ASSERT_FALSE(rig.interpreter.run("G5.3"));
  ASSERT_TRUE(rig.interpreter.has_extent());
  EXPECT_EQ(rig.interpreter.extent().high(), at(2, 1));
  const auto actions = rig.take();
  EXPECT_GT(actions.size(), 20u);
  EXPECT_EQ(actions.back().target_e7, at(0, 0));
  EXPECT_TRUE(actions.back().programmed_end);
}

TEST(Nurbs, Refusals) {
  expect_rows({
      {"F60|G5.3", "35@1"},
      {"F60|G5.2 L1", "39@6"},
      {"F60|G5.2 L7", "39@6"},
      {"F60|G5.2 P0.001", "39@6"},
      {"F60|G5.2 P-1", "4@6"},
      {"F60|G5.2 X1", "28@6"},
      {"F60|G5.2 Z1", "31@6"},
      {"F60|G18 G5.2 X1 Y1", "20@5"},
      {"F60|G41.1 D1 G5.2", "90@10"},
      {"F60|G5.2|X1", "28@1"},
      {"F60|G5.2|X1 Y1 Z1", "31@7"},
      {"F60|G5.2|X1 Y1 Q1", "36@7"},
      {"F60|G5.2|M3", "20@1"},
      {"F60|G5.2|G1 X1 Y1", "20@1"},
      {"F60|G5.2|X1 Y1|G5.3", "35@1"},
      {"F60|G5.2|X1 Y1|X2 Y2|G5.3 M3", "20@1"},
      {"F60|G5.2|X1 Y1|X2 Y2|G5.3 X1", "36@6"},
      {"G5.2|X1 Y1|X2 Y2|G5.3", "22@1"},
  });
  Rig rig;
  rig.run("F60");
  rig.run("G5.2");
  EXPECT_EQ(rig.jog("X1"), "8@1");
  for (std::uint32_t i = 1; i < NurbsPoints::capacity; ++i) EXPECT_EQ(rig.run("X1 Y1"), "");
  EXPECT_EQ(rig.run("X1 Y1"), "39@1");
  rig.interpreter.reset();
  EXPECT_EQ(rig.run("G0 X1 Y1"), "rapid to 1 1 0");
}

}  // namespace
}  // namespace lamplock::program::nurbs_test
