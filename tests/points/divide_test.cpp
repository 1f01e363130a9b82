#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "host/model/arc_length.hpp"
#include "host/model/spline.hpp"
#include "host/points/divide.hpp"
#include "tests/points/shapes.hpp"
#include "tests/scale.hpp"

namespace lamplock {
namespace {

using geometry::Point;
using geometry::PointCloud;
using model::Arc;
using model::Curves;
using model::Line;
using points::divide;
using points::DivideOptions;
using std::numbers::pi;
using test::distance;
using test::error_of;

Curves drawing_of(model::Path path) {
  Curves curves;
  curves.layers = {"0"};
  curves.paths = {std::move(path)};
  return curves;
}

Curves circle(double radius) {
  return drawing_of({{Arc{{}, {radius, 0, 0}, {0, radius, 0}, 0, 2 * pi}}, true});
}

Curves line(double length) { return drawing_of({{Line{{1, 2, 3}, {1 + length, 2, 3}}}}); }

TEST(Divide, CircleGivesEqualAnglesAndNoDoubledEnd) {
  const PointCloud cloud = divide(circle(10), {.spacing_mm = 0.3});
  ASSERT_EQ(cloud.size(), 209u);  // 62.83 / 0.3
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double angle = 2 * pi * static_cast<double>(i) / 209;
    EXPECT_LT(distance(cloud[i], {10 * std::cos(angle), 10 * std::sin(angle), 0}), 1e-8);
  }
}

// Equal arc length on an ellipse and on splines, compared with the length of the polyline through
// very many points between neighbours.
TEST(Divide, EllipseAndSplineGiveEqualArcLengths) {
  std::mt19937_64 random(1);
  for (int i = 0; i < test::scaled(20); ++i) {
    const bool is_ellipse = i % 2 == 0;
    const double a = 5 + static_cast<double>(random() % 20),
                 b = 1 + static_cast<double>(random() % 4);
    const auto poles = test::random_cloud(random, 4, 20);
    const Curves curves = is_ellipse
                              ? drawing_of({{Arc{{}, {a, 0, 0}, {0, b, 0}, 0, 2 * pi}}, true})
                              : drawing_of({{model::bezier(poles)}});
    const double spacing = 0.7;
    const PointCloud wide = divide(curves, {.spacing_mm = spacing});
    const std::size_t gaps = is_ellipse ? wide.size() : wide.size() - 1;
    // Division by 200 times as many gaps gives the same points at every 200th place.
    const double length = model::ArcLength(curves.paths[0]).total();
    const std::size_t parts = 200;
    const PointCloud fine =
        divide(curves, {.spacing_mm = length / static_cast<double>(gaps * parts)});
    ASSERT_EQ(fine.size(), gaps * parts + (is_ellipse ? 0 : 1));
    for (std::size_t k = 0; k < wide.size(); ++k) {
      EXPECT_LT(distance(wide[k], fine[k * parts]), 1e-7);
    }
    for (std::size_t k = 0; k + 1 < wide.size(); ++k) {
      double between = 0;
      for (std::size_t n = k * parts; n < (k + 1) * parts; ++n) {
        between += distance(fine[n], fine[n + 1]);
      }
      EXPECT_NEAR(between, length / static_cast<double>(gaps), 1e-4);
    }
    EXPECT_GE(length / static_cast<double>(gaps), spacing);
  }
}

TEST(Divide, OpenCurvesEndExactlyAtTheirEndsOnRequest) {
  const PointCloud ends = divide(line(10.05), {.spacing_mm = 1});
  ASSERT_EQ(ends.size(), 11u);
  EXPECT_EQ(ends.front(), (Point{1, 2, 3}));
  EXPECT_EQ(ends.back(), (Point{11.05, 2, 3}));
  const PointCloud inner = divide(line(10), {.spacing_mm = 1, .end_points = false});
  ASSERT_EQ(inner.size(), 10u);
  EXPECT_NEAR(inner.front().x, 1.5, 1e-9);
  EXPECT_NEAR(inner.back().x, 10.5, 1e-9);
}

TEST(Divide, ADistanceThatFitsExceptForRoundingIsAccepted) {
  EXPECT_EQ(divide(line(0.3), {.spacing_mm = 0.1}).size(), 4u);
  EXPECT_EQ(divide(line(70), {.spacing_mm = 0.7}).size(), 101u);
}

TEST(Divide, ShortCurvesAndPointsAreKept) {
  Curves curves = circle(0.001);
  curves.paths.push_back({{Line{{5, 0, 0}, {5.01, 0, 0}}}});
  curves.paths.push_back({{Line{{6, 0, 0}, {6, 0, 0}}}});
  curves.points = {{7, 8, 9}};
  const PointCloud cloud = divide(curves, {.spacing_mm = 1});
  ASSERT_EQ(cloud.size(), 5u);
  EXPECT_EQ(cloud[1], (Point{5, 0, 0}));
  EXPECT_EQ(cloud[2], (Point{5.01, 0, 0}));
  EXPECT_EQ(cloud[3], (Point{6, 0, 0}));
  EXPECT_EQ(cloud[4], (Point{7, 8, 9}));
}

TEST(Divide, LayersAreStackedRoundTheDrawingsOwnHeight) {
  Curves curves = line(1);
  curves.points = {{0, 0, 5}};
  const PointCloud one = divide(curves, {.spacing_mm = 0.5});
  const PointCloud three = divide(curves, {.spacing_mm = 0.5, .layers = 3, .layer_mm = 0.25});
  ASSERT_EQ(one.size(), 4u);
  ASSERT_EQ(three.size(), 12u);
  for (std::size_t i = 0; i < three.size(); ++i) {
    Point expected = one[i % 4];
    const std::size_t layer = i / 4;
    expected.z += 0.25 * (static_cast<double>(layer) - 1);
    EXPECT_EQ(three[i], expected);
  }
}

TEST(Divide, TwistTurnsClosedCurvesFromLayerToLayer) {
  const double spacing = 2 * pi * 10 / 100;
  const PointCloud cloud = divide(
      circle(10), {.spacing_mm = spacing, .layers = 4, .layer_mm = 1, .twist_mm = 0.4 * spacing});
  ASSERT_EQ(cloud.size(), 400u);
  for (std::size_t k = 0; k < 4; ++k) {
    const double angle = std::fmod(0.4 * static_cast<double>(k), 1.0) * 2 * pi / 100;
    const Point& first = cloud[100 * k];
    EXPECT_NEAR(std::atan2(first.y, first.x), angle, 1e-9);
    EXPECT_NEAR(first.z, static_cast<double>(k) - 1.5, 1e-12);
  }
  EXPECT_EQ(divide(line(3), {.spacing_mm = 1, .layers = 2, .twist_mm = 0.3}).front().x, 1);
}

TEST(Divide, WrongOptionsAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const DivideOptions& options :
       {DivideOptions{.spacing_mm = 0}, DivideOptions{.spacing_mm = nan},
        DivideOptions{.spacing_mm = 1e-9}, DivideOptions{.layers = 0},
        DivideOptions{.layers = 2, .layer_mm = 0}, DivideOptions{.twist_mm = nan},
        DivideOptions{.layers = std::numeric_limits<int>::max()}}) {
    EXPECT_NE(error_of([&] { divide(circle(10), options); }), "");
  }
  EXPECT_TRUE(divide(Curves{}, {}).empty());
}

}  // namespace
}  // namespace lamplock
