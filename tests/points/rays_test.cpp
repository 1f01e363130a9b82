#include <gtest/gtest.h>

#include <map>

#include "host/geometry/bounds.hpp"
#include "host/points/rays.hpp"
#include "tests/points/shapes.hpp"
#include "tests/scale.hpp"

namespace lamplock {
namespace {

using geometry::Axis;
using geometry::PointCloud;
using points::rays;
using test::error_of;

/// Depths of the hits of every ray along z.
std::map<std::pair<double, double>, std::vector<double>> by_ray(const PointCloud& cloud) {
  std::map<std::pair<double, double>, std::vector<double>> found;
  for (const auto& p : cloud) found[{p.x, p.y}].push_back(p.z);
  return found;
}

TEST(Rays, SphereIsHitTwiceOnItsSurface) {
  const auto found = by_ray(rays(test::sphere(10, 199, 400), {.pitch_mm = 0.5}));
  EXPECT_NEAR(static_cast<double>(found.size()), std::numbers::pi * 100 / 0.25, 40);
  for (const auto& [ray, depths] : found) {
    EXPECT_EQ(depths.size(), 2u);
    const double r2 = ray.first * ray.first + ray.second * ray.second;
    for (const double z : depths) EXPECT_NEAR(z * z + r2, 100, 0.05);
  }
}

TEST(Rays, TorusIsHitUpToFourTimes) {
  // Upright torus: exchange y and z.
  model::Mesh mesh = test::torus(10, 3, 200, 100, 0.01);
  for (auto& v : mesh.vertices) v = {v.x, v.z, v.y};
  std::map<std::size_t, int> rays_with;
  for (const auto& [ray, depths] : by_ray(rays(mesh, {.pitch_mm = 0.25}))) {
    ++rays_with[depths.size()];
    const auto [x, y] = ray;
    if (std::abs(y) < 2.5 && std::abs(x) < 6.5) {
      EXPECT_EQ(depths.size(), 4u);
    }
    for (const double z : depths) {
      EXPECT_NEAR(std::hypot(std::hypot(x, z) - 10, y), 3, 0.02);
    }
  }
  EXPECT_EQ(rays_with.size(), 2u);
  EXPECT_GT(rays_with[2], 0);
  EXPECT_GT(rays_with[4], 0);
}

// Rays through vertices and along edges: every hit counts once, so numbers stay even.
TEST(Rays, ClosedBodiesAreHitAnEvenNumberOfTimesOnTheLattice) {
  std::mt19937_64 random(7);
  for (int i = 0; i < test::scaled(100); ++i) {
    model::Mesh mesh =
        i % 3 == 0   ? test::sphere(6, 3 + test::below(random, 6), 4 + test::below(random, 6))
        : i % 3 == 1 ? test::torus(6, 3, 4 + test::below(random, 8), 4 + test::below(random, 6))
                     : test::box(2.5, 3.5, 4.5);
    for (auto& v : mesh.vertices) {
      v = {std::round(v.x * 2) / 2, std::round(v.y * 2) / 2, std::round(v.z * 2) / 2};
    }
    for (const double pitch : {0.5, 1.0, 0.25}) {
      for (const auto& [ray, depths] : by_ray(rays(mesh, {.pitch_mm = pitch}))) {
        EXPECT_EQ(depths.size() % 2, 0u) << ray.first << ' ' << ray.second;
      }
    }
  }
}

TEST(Rays, ABoxIsHitExactlyTwicePerRayWithNoneLost) {
  const auto found = by_ray(rays(test::box(5, 5, 2), {.pitch_mm = 1}));
  EXPECT_EQ(found.size(), 100u);
  for (const auto& [ray, depths] : found) {
    EXPECT_EQ(depths.size(), 2u);
    for (const double z : depths) EXPECT_NEAR(std::abs(z), 2, 1e-12);
    EXPECT_NEAR(std::abs(ray.first - std::floor(ray.first)), 0.5, 1e-12);
  }
}

TEST(Rays, DirectionsAreEquivalent) {
  const model::Mesh mesh = test::torus(10, 3, 60, 30, 0.1);
  model::Mesh turned = mesh;  // (x, y, z) -> (z, x, y): rays along z become rays along x
  for (auto& v : turned.vertices) v = {v.z, v.x, v.y};
  PointCloud along_x = rays(turned, {.pitch_mm = 0.5, .direction = Axis::x});
  for (auto& p : along_x) p = {p.y, p.z, p.x};
  EXPECT_EQ(rays(mesh, {.pitch_mm = 0.5}), along_x);
  for (auto& v : turned.vertices) v = {v.z, v.x, v.y};
  PointCloud along_y = rays(turned, {.pitch_mm = 0.5, .direction = Axis::y});
  for (auto& p : along_y) p = {p.z, p.x, p.y};
  EXPECT_EQ(rays(mesh, {.pitch_mm = 0.5}), along_y);
}

TEST(Rays, PointsStayInsideTheBox) {
  std::mt19937_64 random(8);
  for (int i = 0; i < test::scaled(30); ++i) {
    const double scale = std::pow(10.0, static_cast<double>(random() % 7) - 3);
    model::Mesh mesh = test::torus(10 * scale, 3 * scale, 30, 20, 0.1);
    for (auto& v : mesh.vertices) v.x += 50 * scale;
    const auto box = geometry::bounds(mesh.vertices);
    const auto cloud = rays(mesh, {.pitch_mm = scale * 0.37});
    EXPECT_GT(cloud.size(), 1000u);
    for (const auto& p : cloud) EXPECT_TRUE(box.contains(p));
  }
}

TEST(Rays, WrongOptionsAreRefused) {
  EXPECT_NE(error_of([] { rays(test::box(5, 5, 5), {.pitch_mm = 0}); }), "");
  EXPECT_NE(error_of([] { rays(test::box(5, 5, 5), {.pitch_mm = 1e-3}); }), "");
  EXPECT_NE(error_of([] { rays(test::box(5, 5, 5), {.pitch_mm = 1e-9}); }), "");
  // Refused before the hits are computed, which would take minutes.
  EXPECT_NE(error_of([] { rays(test::sphere(5, 99, 200), {.pitch_mm = 1e-4}); }), "");
  EXPECT_TRUE(rays({}, {}).empty());
}

}  // namespace
}  // namespace lamplock
