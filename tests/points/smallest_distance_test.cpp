// The smallest distance of the points of every discretiser, on random meshes and on meshes whose
// corners lie on a lattice of the distance.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "host/points/blue_noise.hpp"
#include "host/points/fill_faces.hpp"
#include "host/points/fill_solid.hpp"
#include "host/points/rays.hpp"
#include "host/points/slice.hpp"
#include "host/points/weld.hpp"
#include "tests/points/sampling.hpp"
#include "tests/scale.hpp"

namespace lamplock::smallest_distance {
namespace {

using geometry::PointCloud;
using model::Mesh;

/// Triangles between corners that are multiples of the distance, or anywhere.
Mesh random_triangles(std::mt19937_64& random, double distance, bool lattice) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    const auto coordinate = [&] {
      const auto rank = static_cast<double>(test::below(random, 13)) - 6;
      return lattice ? rank * distance : rank * distance * (1 + 1e-3 * test::below(random, 100));
    };
    mesh.vertices.push_back({coordinate(), coordinate(), coordinate()});
  }
  for (std::uint32_t i = 0; i < 12; ++i) {
    const std::uint32_t a = test::below(random, 8), b = test::below(random, 8),
                        c = test::below(random, 8);
    if (a != b && b != c && c != a) mesh.triangles.push_back({a, b, c});
  }
  mesh.triangles.push_back({0, 1, 2});
  return mesh;
}

Mesh random_box(std::mt19937_64& random, double distance) {
  const auto half = [&] { return distance * (1 + static_cast<double>(test::below(random, 4))); };
  return test::box(half(), half(), half());
}

TEST(SmallestDistance, OfEveryDiscretiserIsNeverBelowTheSpacing) {
  std::mt19937_64 random(31);
  for (int i = 0; i < test::scaled(200); ++i) {
    const double d = 0.02 + static_cast<double>(test::below(random, 1000)) / 3000;
    const Mesh mesh = i % 3 == 0 ? random_box(random, d) : random_triangles(random, d, i % 3 == 1);
    const auto expect_apart = [&](const std::string& method, const PointCloud& cloud) {
      ASSERT_GE(test::min_square(cloud), d * d) << method << ' ' << i << ' ' << d;
    };
    expect_apart("blue noise", points::blue_noise(mesh, {.distance_mm = d, .threads = 1}));
    expect_apart("faces", points::fill_faces(mesh, {.distance_mm = d}).points);
    expect_apart("rays", points::weld(points::rays(mesh, {.pitch_mm = d}), d).points);
    expect_apart("slice",
                 points::weld(points::slice(mesh, {.layer_mm = d, .vertex_mm = d}), d).points);
    if (i % 3 == 0)
      expect_apart("solid", points::fill_solid(mesh, {.distance_mm = d, .threads = 1}));
  }
}

}  // namespace
}  // namespace lamplock::smallest_distance
