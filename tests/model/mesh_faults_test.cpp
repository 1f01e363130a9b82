#include "host/model/mesh_faults.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "host/model/example.hpp"
#include "tests/points/shapes.hpp"
#include "tests/scale.hpp"

namespace lamplock {
namespace {

using model::find_faults;
using model::Mesh;
using model::warnings;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(MeshFaults, SoundBodiesHaveNone) {
  for (const Mesh& mesh : {test::box(1, 2, 3), test::sphere(2, 9, 12), test::torus(5, 2, 12, 9),
                           model::example_model()}) {
    const auto faults = find_faults(mesh);
    EXPECT_TRUE(faults.none());
    EXPECT_TRUE(faults.closed);
    EXPECT_TRUE(warnings(faults).empty());
  }
}

TEST(MeshFaults, AHoleIsNamedByItsFirstEdge) {
  Mesh mesh = test::box(1, 1, 1);
  mesh.triangles.erase(mesh.triangles.begin() + 2);  // of the top
  const auto faults = find_faults(mesh);
  EXPECT_FALSE(faults.closed);
  EXPECT_EQ(faults.open_edges.count, 3u);
  EXPECT_EQ(faults.open_edges.triangle, 2u);
  EXPECT_EQ(faults.open_edges.from.z, 1);
  EXPECT_THAT(warnings(faults), ElementsAre(HasSubstr("3 open edges, the first at triangle 2")));
}

TEST(MeshFaults, AReversedTriangleHasThreeReversedEdges) {
  Mesh mesh = test::sphere(3, 9, 12);
  std::swap(mesh.triangles[40][0], mesh.triangles[40][1]);
  const auto faults = find_faults(mesh);
  EXPECT_EQ(faults.turned_edges.count, 3u);
  EXPECT_LE(faults.turned_edges.triangle, 40u);
  EXPECT_TRUE(faults.closed);
  EXPECT_FALSE(faults.none());
  EXPECT_THAT(warnings(faults), ElementsAre(HasSubstr("opposite orientation")));
}

TEST(MeshFaults, InsideOutIsReported) {
  Mesh mesh = test::torus(5, 2, 12, 9);
  for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
  for (auto& vertex : mesh.vertices) vertex.x += 1000;  // far from the origin
  const auto faults = find_faults(mesh);
  EXPECT_TRUE(faults.inside_out);
  EXPECT_EQ(faults.turned_edges.count, 0u);
  EXPECT_THAT(warnings(faults), ElementsAre(HasSubstr("inside out")));
}

TEST(MeshFaults, AnEdgeOfThreeAndOfFourTriangles) {
  Mesh mesh = test::box(1, 1, 1);
  mesh.vertices.push_back({0, 0, 5});
  mesh.triangles.push_back({4, 5, 8});  // a fin on the edge of the top
  auto faults = find_faults(mesh);
  EXPECT_EQ(faults.non_manifold_edges.count, 1u);
  EXPECT_EQ(faults.open_edges.count, 2u);
  EXPECT_FALSE(faults.closed);
  EXPECT_THAT(warnings(faults), ElementsAre(HasSubstr("2 open edges, the first at triangle 12"),
                                            HasSubstr("more than two")));
  // Two boxes that share an edge: four triangles there, but still closed for rays.
  mesh = test::box(1, 1, 1);
  const Mesh other = test::box(1, 1, 1);
  std::vector<std::uint32_t> number;
  for (std::uint32_t i = 0; i < 8; ++i) {
    auto p = other.vertices[i];
    p.x += 2;
    p.y += 2;
    if (p.x == 1 && p.y == 1) {
      number.push_back(p.z > 0 ? 7 : 3);
      continue;
    }
    number.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
    mesh.vertices.push_back(p);
  }
  for (const auto& [a, b, c] : other.triangles) {
    mesh.triangles.push_back({number[a], number[b], number[c]});
  }
  faults = find_faults(mesh);
  EXPECT_EQ(faults.non_manifold_edges.count, 1u);
  EXPECT_EQ(faults.open_edges.count, 0u);
  EXPECT_TRUE(faults.closed);
}

TEST(MeshFaults, FlatMissingAndNotFiniteAreCounted) {
  Mesh mesh = test::box(1, 1, 1);
  mesh.vertices.push_back({0, -1, -1});
  mesh.triangles.push_back({0, 1, 8});  // on a line
  mesh.triangles.push_back({0, 0, 1});
  mesh.triangles.push_back({0, 1, 99});
  mesh.vertices[8].x = 0;
  auto faults = find_faults(mesh);
  EXPECT_EQ(faults.flat_triangles.count, 2u);
  EXPECT_EQ(faults.flat_triangles.triangle, 12u);
  EXPECT_EQ(faults.missing_vertices.count, 1u);
  EXPECT_EQ(faults.missing_vertices.triangle, 14u);
  EXPECT_FALSE(faults.closed);
  mesh.vertices[5].y = std::numeric_limits<double>::quiet_NaN();
  faults = find_faults(mesh);
  EXPECT_EQ(faults.not_finite_vertices.count, 1u);
  EXPECT_EQ(faults.not_finite_vertices.triangle, 5u);
  EXPECT_THAT(warnings(faults), ::testing::Contains(HasSubstr("the first is 5 at (1, nan, 1)")));
  EXPECT_FALSE(find_faults({}).closed);
  EXPECT_TRUE(find_faults({}).none());
}

TEST(MeshFaults, AnyMeshIsAccepted) {
  std::mt19937_64 random(1);
  for (int i = 0; i < test::scaled(200); ++i) {
    Mesh mesh;
    mesh.vertices = test::random_cloud(random, test::below(random, 8), 1);
    if (!mesh.vertices.empty() && i % 5 == 0) mesh.vertices[0].x = 1e308;
    for (std::uint32_t k = test::below(random, 20); k > 0; --k) {
      mesh.triangles.push_back(
          {test::below(random, 9), test::below(random, 9), test::below(random, 9)});
    }
    const auto faults = find_faults(mesh);
    EXPECT_EQ(faults.none(), warnings(faults).empty());
  }
}

}  // namespace
}  // namespace lamplock
