// What is inside a mesh: random unions of boxes and balls, inside out, duplicated and with
// cavities, against the bodies themselves.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "host/points/fill_solid.hpp"
#include "host/points/inside.hpp"
#include "tests/points/sampling.hpp"
#include "tests/scale.hpp"

namespace lamplock::solid_union {
namespace {

using geometry::Point;
using geometry::PointCloud;
using model::Mesh;

Mesh turned(Mesh mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

Mesh moved(Mesh mesh, const Point& by) {
  for (Point& p : mesh.vertices) p = {p.x + by.x, p.y + by.y, p.z + by.z};
  return mesh;
}

void append(Mesh& mesh, const Mesh& more) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
  for (const auto& [a, b, c] : more.triangles)
    mesh.triangles.push_back({first + a, first + b, first + c});
}

/// A box, or a ball that may have a cavity.
struct Shape {
  Point middle{};
  Point half{};  // half the sides of the box, or the radius in x
  bool ball = false;
  double cavity = 0;  // radius
  bool inside_out = false;
  int copies = 1;

  /// Whether a place is inside by more than `margin`; outside for a negative one.
  bool contains(const Point& p, double margin) const {
    const double x = p.x - middle.x, y = p.y - middle.y, z = p.z - middle.z;
    if (!ball)
      return std::abs(x) < half.x - margin && std::abs(y) < half.y - margin &&
             std::abs(z) < half.z - margin;
    const double r = std::hypot(x, y, z);
    return r < half.x - margin && (cavity == 0 || r > cavity + margin);
  }

  Mesh mesh() const {
    Mesh body = ball ? test::sphere(half.x, 19, 40) : test::box(half.x, half.y, half.z);
    if (cavity > 0) append(body, turned(test::sphere(cavity, 19, 40)));
    if (inside_out) body = turned(std::move(body));
    return moved(std::move(body), middle);
  }
};

/// Ball meshes lie inside their balls by less than this part of the radius.
constexpr double chord = 0.01;

bool is_inside(const std::vector<Shape>& shapes, const Point& p, double margin) {
  return std::any_of(shapes.begin(), shapes.end(),
                     [&](const Shape& shape) { return shape.contains(p, margin); });
}

double between(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// Shapes of which none lies wholly in the box of another: that would make a cavity of it if the
/// two have opposite orientations.
std::vector<Shape> random_shapes(std::mt19937_64& random, std::size_t count) {
  std::vector<Shape> shapes;
  while (shapes.size() < count) {
    const auto middle = [&] { return between(random, -3, 3); };
    const auto half = [&] { return between(random, 2, 4); };
    Shape shape{{middle(), middle(), middle()}, {half(), half(), half()}};
    shape.ball = random() % 2 == 0;
    if (shape.ball) shape.half = {shape.half.x, shape.half.x, shape.half.x};
    if (shape.ball && random() % 2 == 0) shape.cavity = shape.half.x / 2;
    shape.inside_out = random() % 2 == 0;
    shape.copies = 1 + static_cast<int>(random() % 2);
    const auto nested = [&](const Shape& a, const Shape& b) {
      return std::abs(a.middle.x - b.middle.x) <= a.half.x - b.half.x &&
             std::abs(a.middle.y - b.middle.y) <= a.half.y - b.half.y &&
             std::abs(a.middle.z - b.middle.z) <= a.half.z - b.half.z;
    };
    if (std::none_of(shapes.begin(), shapes.end(), [&](const Shape& other) {
          return nested(shape, other) || nested(other, shape);
        }))
      shapes.push_back(shape);
  }
  return shapes;
}

Mesh mesh_of(const std::vector<Shape>& shapes) {
  Mesh mesh;
  for (const Shape& shape : shapes) {
    const std::size_t first = mesh.triangles.size();
    append(mesh, shape.mesh());
    // Copies name the same vertices, as readers make them.
    const std::vector<std::array<std::uint32_t, 3>> body(
        mesh.triangles.begin() + static_cast<std::ptrdiff_t>(first), mesh.triangles.end());
    for (int copy = 1; copy < shape.copies; ++copy)
      mesh.triangles.insert(mesh.triangles.end(), body.begin(), body.end());
  }
  return mesh;
}

TEST(Inside, AgreesWithRandomUnions) {
  std::mt19937_64 random(21);
  for (int i = 0; i < test::scaled(60); ++i) {
    const std::vector<Shape> shapes = random_shapes(random, 1 + random() % 6);
    const Mesh mesh = mesh_of(shapes);
    const points::Inside inside(mesh);
    for (const Point& place : test::random_cloud(random, 400, 7)) {
      if (is_inside(shapes, place, 4 * chord)) {
        ASSERT_TRUE(inside.contains(place)) << i;
      } else if (!is_inside(shapes, place, -4 * chord)) {
        ASSERT_FALSE(inside.contains(place)) << i;
      }
    }
  }
}

/// The share of each height that is filled, by steps.
TEST(Inside, ThicknessAboveIsThatOfTheUnion) {
  std::mt19937_64 random(22);
  for (int i = 0; i < test::scaled(20); ++i) {
    const std::vector<Shape> shapes = random_shapes(random, 4);
    const Mesh mesh = mesh_of(shapes);
    const points::Inside inside(mesh);
    for (const Point& place : test::random_cloud(random, 10, 5)) {
      // The facets differ from the shapes by a chord: near a flank of a sphere that is much of its
      // height, so the bounds are those of shapes that are smaller and larger by it.
      double least = 0, most = 0;
      constexpr double step = 0.002, rounding = 20 * step;
      for (int k = 0; place.z + k * step < 8; ++k) {
        const Point at{place.x, place.y, place.z + k * step};
        least += is_inside(shapes, at, 4 * chord) ? step : 0;
        most += is_inside(shapes, at, -4 * chord) ? step : 0;
      }
      EXPECT_GE(inside.filled_above_mm(place), least - rounding) << i;
      EXPECT_LE(inside.filled_above_mm(place), most + rounding) << i;
    }
  }
}

/// Points per cubic distance at places that are deeper than a skin, by the number of bodies there.
struct Density {
  std::array<double, 3> points{}, places{};

  void add(const std::vector<Shape>& shapes, const Point& p, std::array<double, 3>& counts,
           double skin) const {
    if (!is_inside(shapes, p, skin)) return;
    const auto bodies = std::count_if(shapes.begin(), shapes.end(),
                                      [&](const Shape& shape) { return shape.contains(p, 0); });
    ++counts[std::min<std::size_t>(static_cast<std::size_t>(bodies), 3) - 1];
  }
};

TEST(FillSolid, HasOneDensityEverywhereInAUnion) {
  std::mt19937_64 random(23);
  constexpr double half = 7.5, distance = 0.45, skin = 2 * distance;
  constexpr std::size_t samples = 400'000;
  constexpr double per_place = 8 * half * half * half / samples;
  // With fewer points where three bodies are, chance alone exceeds the 3 %.
  constexpr double min_points = 1500;
  Density density;
  for (int i = 0; i < test::scaled(6) || density.points[2] < min_points; ++i) {
    const std::vector<Shape> shapes = random_shapes(random, 4);
    const PointCloud cloud =
        points::fill_solid(mesh_of(shapes), {.distance_mm = distance, .seed = random()});
    EXPECT_GE(test::min_square(cloud), distance * distance);
    for (const Point& p : cloud) {
      ASSERT_TRUE(is_inside(shapes, p, -4 * chord));
      density.add(shapes, p, density.points, skin);
    }
    for (const Point& p : test::random_cloud(random, samples, half))
      density.add(shapes, p, density.places, skin);
  }
  // The same depth in a plain box.
  Density plain;
  const std::vector<Shape> box{{{}, {5, 5, 5}}};
  for (const Point& p : points::fill_solid(mesh_of(box), {.distance_mm = distance}))
    plain.add(box, p, plain.points, skin);
  const double side = 2 * (5 - skin), wanted = plain.points[0] / (side * side * side);
  for (std::size_t bodies = 0; bodies < 3; ++bodies) {
    const double found = density.points[bodies] / (density.places[bodies] * per_place);
    EXPECT_NEAR(found / wanted, 1, 0.03) << bodies + 1 << " bodies";
  }
}

/// Two balls, one in the other, with all orientations.
TEST(Inside, ACavityIsABodyOfTheOtherOrientationInside) {
  for (const bool outer : {false, true}) {
    for (const bool inner : {false, true}) {
      Mesh mesh = outer ? turned(test::sphere(5, 20, 40)) : test::sphere(5, 20, 40);
      append(mesh, inner ? turned(test::sphere(3, 20, 40)) : test::sphere(3, 20, 40));
      const points::Inside inside(mesh);
      EXPECT_EQ(inside.contains({0, 0.1, 0.2}), outer == inner);
      EXPECT_TRUE(inside.contains({0, 4, 0}));
      EXPECT_FALSE(inside.contains({0, 5.1, 0}));
    }
  }
}

TEST(Inside, TurnedDuplicatedAndTwoSidedTrianglesDoNotMatter) {
  std::mt19937_64 random(24);
  const Mesh ball = test::sphere(4, 12, 24);
  Mesh body = ball;
  append(body, moved(test::box(1, 1, 1), {6, 0, 0}));
  for (int i = 0; i < test::scaled(40); ++i) {
    Mesh mesh = body;
    for (auto& triangle : mesh.triangles)
      if (random() % 3 == 0) std::swap(triangle[1], triangle[2]);
    const auto single = mesh.triangles;
    if (i % 4 == 1) mesh.triangles.insert(mesh.triangles.end(), single.begin(), single.end());
    if (i % 4 == 2)
      for (auto triangle : single) {
        std::swap(triangle[0], triangle[2]);
        mesh.triangles.push_back(triangle);
      }
    std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
    const points::Inside inside(mesh);
    for (const Point& place : test::random_cloud(random, 200, 7)) {
      const bool in_box =
          std::max({std::abs(place.x - 6), std::abs(place.y), std::abs(place.z)}) < 1;
      const double r = std::hypot(place.x, place.y, place.z);
      if (in_box || r < 3.8) {
        ASSERT_TRUE(inside.contains(place)) << i;
      } else if (r > 4) {
        ASSERT_FALSE(inside.contains(place)) << i;
      }
    }
  }
}

/// Bodies that touch in a face, an edge or a corner name the same vertices.
TEST(Inside, BodiesThatTouchAreBothFilled) {
  for (const Point& by : {Point{2, 0, 0}, Point{2, 2, 0}, Point{2, 2, 2}, Point{0, 0, 2}}) {
    for (const bool inside_out : {false, true}) {
      Mesh mesh = test::box(1, 1, 1);
      Mesh more = moved(test::box(1, 1, 1), by);
      // A common face is named once by each body; otherwise one body may be inside out.
      if (inside_out && by.x * by.y != 0) more = turned(std::move(more));
      const std::size_t own = mesh.vertices.size();
      append(mesh, more);
      for (auto& triangle : mesh.triangles)
        for (auto& corner : triangle)
          for (std::uint32_t i = 0; i < own; ++i)
            if (mesh.vertices[corner] == mesh.vertices[i]) corner = i;
      const points::Inside inside(mesh);
      EXPECT_TRUE(inside.contains({0.1, 0.2, 0.3}));
      EXPECT_TRUE(inside.contains({by.x + 0.1, by.y + 0.2, by.z + 0.3}));
      EXPECT_FALSE(inside.contains({-1.5, 0, 0}));
      EXPECT_FALSE(inside.contains({0, -1.5, -1.5}));
    }
  }
}

TEST(FillSolid, SomeDuplicatedTrianglesAreNoHole) {
  Mesh mesh = test::box(2, 2, 2);
  const auto plain = points::fill_solid(mesh, {.distance_mm = 0.5});
  for (const std::size_t i : {0u, 5u, 11u}) mesh.triangles.push_back(mesh.triangles[i]);
  std::swap(mesh.triangles.back()[0], mesh.triangles.back()[1]);
  EXPECT_EQ(points::fill_solid(mesh, {.distance_mm = 0.5}), plain);
}

}  // namespace
}  // namespace lamplock::solid_union
