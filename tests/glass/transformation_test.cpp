// Maps of objects: composition, rotation, mirroring, inversion; transformations in words.
#include "host/glass/transformation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "host/model/transform.hpp"
#include "tests/error_of.hpp"
#include "tests/points/shapes.hpp"
#include "tests/scale.hpp"

namespace lamplock::glass {
namespace {

using geometry::Affine;
using geometry::Bounds;
using geometry::Point;
using ::testing::HasSubstr;

constexpr double tolerance_mm = 1e-9;

void expect_near(const Point& a, const Point& b) {
  EXPECT_NEAR(a.x, b.x, tolerance_mm);
  EXPECT_NEAR(a.y, b.y, tolerance_mm);
  EXPECT_NEAR(a.z, b.z, tolerance_mm);
}

Point random_point(std::mt19937_64& random, double reach = 10) {
  std::uniform_real_distribution<> mm(-reach, reach);
  return {mm(random), mm(random), mm(random)};
}

Affine random_map(std::mt19937_64& random) {
  std::uniform_real_distribution<> factor(0.2, 3), degrees(-400, 400);
  const double sign = std::bernoulli_distribution()(random) ? 1 : -1;
  const Point way = random_point(random);
  return geometry::moved(way.x, way.y, way.z) *
         model::turned_about(random_point(random), degrees(random)) *
         geometry::scaled(sign * factor(random), factor(random), factor(random));
}

TEST(Affine, ComposesAndInverts) {
  std::mt19937_64 random(1);
  for (int i = 0; i < test::scaled(500); ++i) {
    const Affine a = random_map(random), b = random_map(random);
    const Point p = random_point(random);
    expect_near((a * b)(p), a(b(p)));
    const auto back = model::inverse(a);
    ASSERT_TRUE(back);
    expect_near((*back)(a(p)), p);
    EXPECT_NEAR(model::determinant(a * b), model::determinant(a) * model::determinant(b),
                1e-9 * std::abs(model::determinant(a) * model::determinant(b)));
  }
  EXPECT_FALSE(model::inverse(geometry::scaled(1, 0, 1)));
  EXPECT_FALSE(model::inverse(geometry::scaled(1, std::nan(""), 1)));
}

TEST(Affine, RotationsKeepLengthsAndTheAxis) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<> degrees(-720, 720);
  for (int i = 0; i < test::scaled(500); ++i) {
    const Point axis = random_point(random), p = random_point(random), q = random_point(random);
    const Affine turn = model::turned_about(axis, degrees(random));
    EXPECT_NEAR(test::distance(turn(p), turn(q)), test::distance(p, q), tolerance_mm);
    expect_near(turn(axis), axis);
    EXPECT_NEAR(model::determinant(turn), 1, tolerance_mm);
  }
}

TEST(Affine, RotatesCounterClockwiseSeenAgainstTheAxis) {
  EXPECT_EQ(model::turned_about({0, 0, 2}, 90)({1, 0, 0}), (Point{0, 1, 0}));
  EXPECT_EQ(model::turned_about({0, 0, -2}, 90)({1, 0, 0}), (Point{0, -1, 0}));
  // A third of a turn about the diagonal permutes the axes cyclically.
  expect_near(model::turned_about({1, 1, 1}, 120)({1, 2, 3}), {3, 1, 2});
}

TEST(Affine, APivotIsFixed) {
  std::mt19937_64 random(3);
  for (int i = 0; i < test::scaled(100); ++i) {
    Affine turn = random_map(random);
    turn.offset = {};
    const Point pivot = random_point(random);
    expect_near(model::about(turn, pivot)(pivot), pivot);
  }
}

/// Sum of the volumes under the triangles: positive if their normals point outwards.
double volume_of_body(const model::Mesh& mesh) {
  double volume = 0;
  for (const auto& t : mesh.triangles) {
    const Point &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    volume += model::determinant({a, b, c, {}}) / 6;
  }
  return volume;
}

TEST(TransformedMesh, NormalsStayOutward) {
  const model::Mesh body = test::sphere(2, 12, 24);
  const double volume = volume_of_body(body);
  std::mt19937_64 random(4);
  for (int i = 0; i < test::scaled(50); ++i) {
    const Affine map = random_map(random);
    const model::Mesh moved = model::transformed(body, map);
    EXPECT_TRUE(test::is_closed(moved));
    EXPECT_NEAR(volume_of_body(moved), volume * std::abs(model::determinant(map)), 1e-6);
  }
}

TEST(TransformedMesh, ColoursFollowTheirCorners) {
  model::Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  mesh.brightness.emplace().corners = {{0.1F, 0.2F, 0.3F}};
  const model::Mesh mirrored = model::transformed(mesh, geometry::scaled(-1, 1, 1));
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const std::uint32_t vertex = mirrored.triangles[0][corner];
    EXPECT_EQ(mirrored.brightness->corners[0][corner], mesh.brightness->corners[0][vertex]);
  }
}

/// A work space from -50 to 50 with a block of 40 x 40 x 60 round (0, 0, 10).
Volume volume() {
  GlassChoice glass;
  glass.block_mm = Triple{40, 40, 60};
  glass.block_at_mm = Triple{0, 0, 10};
  return volume_of(glass, {{-50, -50, -50}, {50, 50, 50}});
}

/// The map of the transformations for a body with these corners.
Affine map_of(const std::vector<std::string>& words, const geometry::PointCloud& corners) {
  const auto under = [&corners](const Affine& map) {
    return geometry::bounds(model::transformed(corners, map));
  };
  return placement({}, words, volume(), under, "object");
}

TEST(Words, EachTransformation) {
  const geometry::PointCloud corners{{1, 2, 3}, {3, 4, 9}};
  const auto moved = [&](const char* words) { return map_of({words}, corners)({1, 2, 3}); };
  EXPECT_EQ(moved("move 1 -2 0.5"), (Point{2, 0, 3.5}));
  EXPECT_EQ(moved("rotate z 90"), (Point{-2, 1, 3}));
  EXPECT_EQ(moved("rotate x 90"), (Point{1, 7, 12}));
  expect_near(moved("rotate 0 0 -7 90"), {2, -1, 3});
  EXPECT_EQ(moved("scale 2"), (Point{2, 4, -4}));
  EXPECT_EQ(moved("scale 2 1 0.5"), (Point{2, 2, 6.5}));
  EXPECT_EQ(moved("mirror x"), (Point{-1, 2, 3}));
  EXPECT_EQ(moved("mirror z"), (Point{1, 2, 17}));
  EXPECT_EQ(moved("centre"), (Point{-1, -1, 7}));
  EXPECT_EQ(moved(" move  1,2,\t3 "), (Point{2, 4, 6}));
}

TEST(Words, AreAppliedInTheirOrder) {
  const geometry::PointCloud corners{{1, 0, 0}};
  EXPECT_EQ(map_of({"move 1 0 0", "rotate z 90"}, corners)({1, 0, 0}), (Point{0, 2, 0}));
  EXPECT_EQ(map_of({"rotate z 90", "move 1 0 0"}, corners)({1, 0, 0}), (Point{1, 1, 0}));
}

TEST(Words, FitTouchesTheMargin) {
  std::mt19937_64 random(5);
  const Bounds room = volume().room();
  for (int i = 0; i < test::scaled(200); ++i) {
    geometry::PointCloud corners;
    for (int k = 0; k < 6; ++k) corners.push_back(random_point(random, 300));
    const Affine map = map_of({"rotate 1 2 3 50", "fit"}, corners);
    const Bounds box = geometry::bounds(model::transformed(corners, map));
    double slack = room.max_side();
    for (const auto& [low, high, room_low, room_high] :
         {std::array{box.low.x, box.high.x, room.low.x, room.high.x},
          std::array{box.low.y, box.high.y, room.low.y, room.high.y},
          std::array{box.low.z, box.high.z, room.low.z, room.high.z}}) {
      EXPECT_GE(low, room_low - tolerance_mm);
      EXPECT_LE(high, room_high + tolerance_mm);
      EXPECT_NEAR(low - room_low, room_high - high, tolerance_mm);
      slack = std::min(slack, low - room_low);
    }
    EXPECT_NEAR(slack, 0, tolerance_mm);
  }
}

TEST(Words, InvalidWordsAreRefused) {
  for (const char* words :
       {"",         " ",          "turn z 5",       "move 1 2",     "move 1 2 3 4", "move a b c",
        "rotate z", "rotate w 3", "rotate 0 0 0 3", "rotate z nan", "scale",        "scale 0",
        "scale -1", "scale 1 2",  "scale inf",      "mirror",       "mirror q",     "mirror x y",
        "centre 1", "fit 2",      "move 1e999 0 0"})
    EXPECT_THAT(test::error_of([&] { check_transformation(words, "a.toml:3"); }),
                HasSubstr("a.toml:3"))
        << words;
  EXPECT_THAT(test::error_of([] { map_of({"fit"}, {{1, 1, 1}}); }), HasSubstr("no extent"));
}

}  // namespace
}  // namespace lamplock::glass
