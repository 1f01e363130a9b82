#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

#include "host/model/arc_length.hpp"
#include "host/model/curves.hpp"
#include "host/model/spline.hpp"
#include "tests/error_of.hpp"
#include "tests/scale.hpp"

namespace lamplock {
namespace {

using geometry::Point;
using model::Arc;
using model::ArcLength;
using model::Curves;
using model::flattened;
using model::Line;
using model::Path;
using model::Piece;
using model::Spline;
using std::numbers::pi;

double distance(const Point& p, const Point& q) {
  return std::hypot(p.x - q.x, p.y - q.y, p.z - q.z);
}

double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

Point random_point(std::mt19937_64& random, double half) {
  return {uniform(random, -half, half), uniform(random, -half, half), uniform(random, -half, half)};
}

/// Clamped, sometimes with repeated inner knots, rational or not.
Spline random_spline(std::mt19937_64& random, bool rational) {
  Spline spline;
  spline.degree = 1 + static_cast<int>(random() % 5);
  const auto order = static_cast<std::size_t>(spline.degree) + 1;
  const std::size_t poles = order + random() % 8;
  for (std::size_t i = 0; i < poles; ++i) {
    spline.poles.push_back(random_point(random, 30));
    if (rational) spline.weights.push_back(uniform(random, 0.2, 5));
  }
  spline.knots.assign(order, 2);
  double knot = 2;
  int alike = spline.degree;  // more would make the curve discontinuous
  for (std::size_t i = order; i < poles; ++i) {
    const bool repeats = random() % 4 == 0 && alike < spline.degree;
    alike = repeats ? alike + 1 : 1;
    if (!repeats) knot += uniform(random, 0.1, 2);
    spline.knots.push_back(knot);
  }
  spline.knots.insert(spline.knots.end(), order, knot + 1);
  return spline;
}

Piece random_piece(std::mt19937_64& random) {
  switch (random() % 4) {
    case 0:
      return Line{random_point(random, 50), random_point(random, 50)};
    case 1:
      return Arc{random_point(random, 20), random_point(random, 20), random_point(random, 20),
                 uniform(random, -4, 4), uniform(random, -4, 4)};
    default:
      return random_spline(random, random() % 2 == 0);
  }
}

/// By Simpson's rule on fine steps between the breaks: another quadrature than the tested one.
double fine_length(const Piece& piece) {
  std::vector<double> breaks{model::range_of(piece).from, model::range_of(piece).to};
  if (const auto* spline = std::get_if<Spline>(&piece)) breaks = model::breaks_of(*spline);
  double length = 0;
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    constexpr int steps = 4000;
    const double h = (breaks[i + 1] - breaks[i]) / steps;
    // An end belongs to two pieces of a spline; use the limit from inside.
    const auto speed = [&](int k) {
      const double inside = k == 0 ? 1e-9 : k == steps ? -1e-9 : 0;
      const Point v = model::motion_at(piece, breaks[i] + (k + inside) * h).speed;
      return std::hypot(v.x, v.y, v.z);
    };
    for (int k = 0; k < steps; k += 2) {
      length += std::abs(h) / 3 * (speed(k) + 4 * speed(k + 1) + speed(k + 2));
    }
  }
  return length;
}

TEST(ArcLength, EqualsFineIntegration) {
  std::mt19937_64 random(1);
  for (int i = 0; i < test::scaled(300); ++i) {
    const Path path{{random_piece(random)}};
    const double expected = fine_length(path.pieces.front());
    EXPECT_NEAR(ArcLength(path).total(), expected, 1e-5 * (1 + expected));
  }
}

TEST(ArcLength, ClosedForms) {
  const Path circle{{Arc{{1, 2, 3}, {5, 0, 0}, {0, 5, 0}, 0, 2 * pi}}, true};
  EXPECT_NEAR(ArcLength(circle).total(), 10 * pi, 1e-9);
  const Path back{{Arc{{1, 2, 3}, {5, 0, 0}, {0, 5, 0}, 1, -2}}};
  EXPECT_NEAR(ArcLength(back).total(), 15, 1e-9);
  // The perimeter of the ellipse 2 : 1 is 4 a E(3/4) = 9.68844822... (Abramowitz and Stegun, table
  // 17.1).
  const Path ellipse{{Arc{{}, {2, 0, 0}, {0, 1, 0}, 0, 2 * pi}}, true};
  EXPECT_NEAR(ArcLength(ellipse).total(), 9.68844822054767619, 1e-9);
  // The parabola y = x^2 from 0 to 1 as a Bezier curve: sqrt(5) / 2 + asinh(2) / 4.
  const Path parabola{{model::bezier({{0, 0, 0}, {0.5, 0, 0}, {1, 1, 0}})}};
  EXPECT_NEAR(ArcLength(parabola).total(), std::sqrt(5.0) / 2 + std::asinh(2.0) / 4, 1e-9);
  // A cusp, where the speed is zero: x = t^2, y = t^3, (13 sqrt(13) - 8) / 27.
  const Path cusp{{model::bezier({{0, 0, 0}, {0, 0, 0}, {1.0 / 3, 0, 0}, {1, 1, 0}})}};
  EXPECT_NEAR(ArcLength(cusp).total(), (13 * std::sqrt(13.0) - 8) / 27, 1e-9);
}

// A quarter of a circle as a rational curve: every point is on it, and arc length is the angle.
TEST(ArcLength, OfARationalCircle) {
  Spline quarter = model::bezier({{1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  quarter.weights = {1, std::numbers::sqrt2 / 2, 1};
  const Path path{{quarter}};
  ArcLength along(path);
  EXPECT_NEAR(along.total(), pi / 2, 1e-10);
  for (int i = 0; i <= 157; ++i) {
    const double s = 0.01 * i;
    const Point p = along.at(s);
    EXPECT_NEAR(std::hypot(p.x, p.y), 1, 1e-12);
    EXPECT_NEAR(std::atan2(p.y, p.x), s, 1e-9);
  }
}

// The length of a path up to at(s) is s: cut the curve there and measure the parts.
TEST(ArcLength, PointsAreAtTheirArcLength) {
  std::mt19937_64 random(2);
  for (int i = 0; i < test::scaled(200); ++i) {
    const Path path{{model::bezier({random_point(random, 9), random_point(random, 9),
                                    random_point(random, 9), random_point(random, 9)})}};
    ArcLength along(path);
    const Spline& whole = std::get<Spline>(path.pieces.front());
    double s = 0;
    for (int k = 0; k < 5; ++k) {
      s += uniform(random, 0, along.total() / 6);
      // The part of the Bezier curve up to the parameter whose point is at(s), by de Casteljau.
      double low = 0, high = 1;
      Path part;
      for (int halving = 0; halving < 50; ++halving) {
        const double t = (low + high) / 2;
        std::vector<Point> row = whole.poles, left{row.front()};
        while (row.size() > 1) {
          for (std::size_t n = 0; n + 1 < row.size(); ++n) {
            row[n] = {row[n].x + t * (row[n + 1].x - row[n].x),
                      row[n].y + t * (row[n + 1].y - row[n].y),
                      row[n].z + t * (row[n + 1].z - row[n].z)};
          }
          row.pop_back();
          left.push_back(row.front());
        }
        part = {{model::bezier(left)}};
        (ArcLength(part).total() < s ? low : high) = t;
      }
      EXPECT_LT(distance(along.at(s), model::end_of(part)), 1e-8);
    }
  }
}

TEST(ArcLength, CrossesManyPiecesAndBack) {
  Path path;
  for (int i = 0; i < 1000; ++i)
    path.pieces.emplace_back(Line{{i * 0.5, 0, 0}, {i * 0.5 + 0.5, 0, 0}});
  ArcLength along(path);
  EXPECT_NEAR(along.total(), 500, 1e-9);
  for (const double s : {3.2, 499.9, 0.1, 250.0, 0.0, 500.0, 7.7, -1.0, 501.0}) {
    EXPECT_NEAR(along.at(s).x, std::clamp(s, 0.0, 500.0), 1e-9);
  }
  EXPECT_EQ(along.at(500), (Point{500, 0, 0}));
}

TEST(Splines, EndsAreTheFirstAndLastPole) {
  std::mt19937_64 random(3);
  for (int i = 0; i < test::scaled(300); ++i) {
    Spline spline = random_spline(random, i % 2 == 0);
    ASSERT_EQ(model::fault_of(spline), "");
    const Path path{{spline}};
    EXPECT_LT(distance(model::start_of(path), spline.poles.front()), 1e-12);
    EXPECT_LT(distance(model::end_of(path), spline.poles.back()), 1e-12);
    // The derivative compared with differences.
    const auto [from, to] = model::range_of(path.pieces.front());
    const double t = uniform(random, from, to), h = 1e-6;
    if (t - h < from || t + h > to) continue;
    const Point p = model::spline_motion(spline, t - h).at,
                q = model::spline_motion(spline, t + h).at;
    const Point v = model::spline_motion(spline, t).speed;
    const bool at_a_break = [&] {
      for (const double knot : model::breaks_of(spline)) {
        if (std::abs(knot - t) <= h) return true;
      }
      return false;
    }();
    if (at_a_break) continue;
    const double size = 1 + std::hypot(v.x, v.y, v.z);
    EXPECT_NEAR((q.x - p.x) / (2 * h), v.x, 1e-4 * size);
    EXPECT_NEAR((q.y - p.y) / (2 * h), v.y, 1e-4 * size);
    EXPECT_NEAR((q.z - p.z) / (2 * h), v.z, 1e-4 * size);
  }
}

TEST(Splines, FaultsAreNamed) {
  const Spline good = model::bezier({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  const auto fault = [&](const std::function<void(Spline&)>& change) {
    Spline spline = good;
    change(spline);
    return model::fault_of(spline);
  };
  EXPECT_EQ(fault([](Spline&) {}), "");
  EXPECT_NE(fault([](Spline& s) { s.degree = 0; }), "");
  EXPECT_NE(fault([](Spline& s) { s.degree = 26; }), "");
  EXPECT_NE(fault([](Spline& s) { s.knots.pop_back(); }), "");
  EXPECT_NE(fault([](Spline& s) { s.poles.clear(); }), "");
  EXPECT_NE(fault([](Spline& s) { s.knots = {0, 0, 0, 0, 0, 0, 0, 0}; }), "");
  EXPECT_NE(fault([](Spline& s) { s.knots = {0, 1, 0, 0, 1, 1, 1, 1}; }), "");
  EXPECT_NE(fault([](Spline& s) { s.weights = {1, 1}; }), "");
  EXPECT_NE(fault([](Spline& s) { s.weights = {1, 0, 1, 1}; }), "");
  EXPECT_NE(fault([](Spline& s) { s.weights = {1, -1, 1, 1}; }), "");
}

TEST(Flattened, IsWithinTheToleranceAndHasTheLength) {
  std::mt19937_64 random(4);
  for (int i = 0; i < test::scaled(100); ++i) {
    const Path path{{random_piece(random)}};
    const double tolerance = i % 2 == 0 ? 0.001 : 0.1;
    const auto vertices = flattened(path, tolerance);
    // Every point of the curve is near the polyline: compare points at equal shares of length.
    const auto [from, to] = model::range_of(path.pieces.front());
    std::size_t near_vertex = 0;
    for (int k = 0; k <= 500; ++k) {
      const Point p = model::motion_at(path.pieces.front(), from + (to - from) * k / 500).at;
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t n = near_vertex; n + 1 < vertices.size(); ++n) {
        const Point &a = vertices[n], &b = vertices[n + 1];
        const Point chord{b.x - a.x, b.y - a.y, b.z - a.z};
        const double square = chord.x * chord.x + chord.y * chord.y + chord.z * chord.z;
        const double dot = (p.x - a.x) * chord.x + (p.y - a.y) * chord.y + (p.z - a.z) * chord.z;
        const double t = square > 0 ? std::clamp(dot / square, 0.0, 1.0) : 0;
        nearest = std::min(nearest,
                           distance(p, {a.x + t * chord.x, a.y + t * chord.y, a.z + t * chord.z}));
      }
      EXPECT_LE(nearest, tolerance * 1.001) << i;
    }
    double length = 0;
    for (std::size_t n = 0; n + 1 < vertices.size(); ++n) {
      length += distance(vertices[n], vertices[n + 1]);
    }
    EXPECT_LE(length, ArcLength(path).total() * (1 + 1e-9) + 1e-9);
  }
}

TEST(CurveBounds, OfArcsAndSplines) {
  std::mt19937_64 random(5);
  for (int i = 0; i < test::scaled(100); ++i) {
    Curves curves;
    curves.paths = {{{random_piece(random)}}, {{random_piece(random)}}};
    curves.points = {random_point(random, 1)};
    geometry::PointCloud fine = curves.points;
    for (const Path& path : curves.paths) {
      const auto vertices = flattened(path, 1e-4);
      fine.insert(fine.end(), vertices.begin(), vertices.end());
    }
    const auto box = model::bounds(curves), expected = geometry::bounds(fine);
    EXPECT_LT(distance(box.low, expected.low), 0.003);
    EXPECT_LT(distance(box.high, expected.high), 0.003);
  }
  EXPECT_EQ(model::bounds(Curves{}).max_side(), 0);
}

TEST(CurveMaps, KeepPointsOfTheCurveAtTheirPlace) {
  std::mt19937_64 random(6);
  for (int i = 0; i < test::scaled(200); ++i) {
    const geometry::Affine map{random_point(random, 2), random_point(random, 2),
                               random_point(random, 2), random_point(random, 50)};
    Curves curves;
    curves.paths = {{{random_piece(random)}}};
    curves.points = {random_point(random, 5)};
    const Curves moved = model::transformed(curves, map);
    const Piece &before = curves.paths[0].pieces[0], &after = moved.paths[0].pieces[0];
    const auto [from, to] = model::range_of(before);
    const double t = uniform(random, std::min(from, to), std::max(from, to));
    EXPECT_LT(distance(map(model::motion_at(before, t).at), model::motion_at(after, t).at), 1e-9);
    EXPECT_LT(distance(map(curves.points[0]), moved.points[0]), 1e-12);
  }
}

TEST(Affine, RotationsComposeAndInvert) {
  using namespace model;
  EXPECT_EQ(geometry::turned_about_z(90)(Point{1, 0, 0}), (Point{0, 1, 0}));
  EXPECT_EQ(geometry::turned_about_x(90)(Point{0, 1, 0}), (Point{0, 0, 1}));
  EXPECT_EQ(geometry::turned_about_y(90)(Point{0, 0, 1}), (Point{1, 0, 0}));
  EXPECT_EQ(geometry::turned_about_z(-270)(Point{1, 0, 0}), (Point{0, 1, 0}));
  EXPECT_NEAR(geometry::turned_about_z(30)(Point{2, 0, 0}).y, 1, 1e-12);
  std::mt19937_64 random(7);
  for (int i = 0; i < test::scaled(200); ++i) {
    const double degrees = uniform(random, -800, 800), radians = degrees * pi / 180;
    const Point along{std::cos(radians), std::sin(radians), 0};
    EXPECT_LT(distance(geometry::turned_about_z(degrees)(Point{1, 0, 0}), along), 1e-12);
    EXPECT_LT(
        distance(geometry::turned_about_x(degrees)(Point{0, 1, 0}), Point{0, along.x, along.y}),
        1e-12);
    EXPECT_LT(
        distance(geometry::turned_about_y(degrees)(Point{0, 0, 1}), Point{along.y, 0, along.x}),
        1e-12);
    const geometry::Affine turn = geometry::moved(1, 2, 3) *
                                  geometry::turned_about_z(uniform(random, -400, 400)) *
                                  geometry::turned_about_y(uniform(random, -400, 400)) *
                                  geometry::turned_about_x(uniform(random, -400, 400));
    const Point p = random_point(random, 50);
    EXPECT_LT(distance(geometry::turned_back(turn)(turn(p)), p), 1e-12);
    EXPECT_LT(
        distance((turn * geometry::scaled(2, 3, 4))(p), turn(Point{2 * p.x, 3 * p.y, 4 * p.z})),
        1e-12);
  }
}

TEST(Curves, ReportUnreadEntities) {
  Curves curves;
  EXPECT_EQ(left_out_text(curves), "");
  curves.left_out = {{"TEXT", 3}, {"HATCH", 1}};
  EXPECT_EQ(left_out_text(curves), "1 HATCH, 3 TEXT");
}

}  // namespace
}  // namespace lamplock
