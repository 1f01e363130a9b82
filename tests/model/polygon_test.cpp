// Triangles of polygons against areas known by construction.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "host/model/polygon_triangles.hpp"
#include "tests/points/shapes.hpp"
#include "tests/scale.hpp"

namespace lamplock::polygon {
namespace {

using geometry::Point;

Point cross(const Point& a, const Point& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

double area(const Point& a, const Point& b, const Point& c) {
  const Point n = cross({b.x - a.x, b.y - a.y, b.z - a.z}, {c.x - a.x, c.y - a.y, c.z - a.z});
  return std::hypot(n.x, n.y, n.z) / 2;
}

// Stars round a centre that sees every corner: their area is that of the triangles to the centre.
TEST(Polygon, TrianglesCoverAStarOnce) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int round = 0; round < test::scaled(400, 20); ++round) {
    const std::size_t count = 3 + random() % 30;
    const bool is_convex = round % 3 == 0;
    const double far = round % 2 == 0 ? 0 : 5.8e6;
    const double tilt = 6 * unit(random), turn = 6 * unit(random);
    const auto place = [&](double angle, double r) {
      const double x = r * std::cos(angle), y = r * std::sin(angle);
      const double z = y * std::sin(tilt), w = y * std::cos(tilt);
      return Point{far + x * std::cos(turn) - w * std::sin(turn),
                   far + x * std::sin(turn) + w * std::cos(turn), far + z};
    };
    std::vector<Point> polygon;
    for (std::size_t i = 0; i < count; ++i)
      polygon.push_back(
          place(2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count),
                is_convex ? 10 : 2 + 8 * unit(random)));
    double whole = 0, sum = 0;
    const Point centre = place(0, 0);
    for (std::size_t i = 0; i < count; ++i)
      whole += area(centre, polygon[i], polygon[(i + 1) % count]);
    // With three or four corners the centre may be outside.
    if (count < 5) continue;
    const auto triangles = model::triangles_of(polygon);
    ASSERT_EQ(triangles.size(), count - 2);
    for (const auto& t : triangles) sum += area(polygon[t[0]], polygon[t[1]], polygon[t[2]]);
    EXPECT_NEAR(sum, whole, 1e-6 * whole + (far > 0 ? 1e-6 : 0)) << round;
  }
}

TEST(Polygon, StraightCornersGiveNoFlatTriangle) {
  // A square with a corner in the middle of every side, from every first corner.
  std::vector<Point> polygon{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0},
                             {2, 2, 0}, {1, 2, 0}, {0, 2, 0}, {0, 1, 0}};
  for (int turn = 0; turn < 8; ++turn) {
    for (const auto& t : model::triangles_of(polygon))
      EXPECT_GT(area(polygon[t[0]], polygon[t[1]], polygon[t[2]]), 0.1);
    std::rotate(polygon.begin(), polygon.begin() + 1, polygon.end());
  }
}

TEST(Polygon, LargeOnesAreConvexOrRefused) {
  std::vector<Point> circle;
  constexpr int corners = 5000;
  for (int i = 0; i < corners; ++i)
    circle.push_back({std::cos(2 * std::numbers::pi * i / corners), 0,
                      std::sin(2 * std::numbers::pi * i / corners)});
  EXPECT_EQ(model::triangles_of(circle).size(), corners - 2u);
  circle[7] = {0, 0, 0};
  EXPECT_TRUE(model::triangles_of(circle).empty());
  circle.resize(model::max_concave_corners);  // also without a hang
  EXPECT_EQ(model::triangles_of(circle).size(), model::max_concave_corners - 2);
  std::mt19937_64 random(4);
  EXPECT_EQ(model::triangles_of(test::random_cloud(random, 500, 1)).size(), 498u);
}

}  // namespace
}  // namespace lamplock::polygon
