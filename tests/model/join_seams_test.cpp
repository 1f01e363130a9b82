// Seams that rounding has opened: joined by the reader, against the mesh without rounding.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <string>

#include "host/model/join_seams.hpp"
#include "host/model/mesh_faults.hpp"
#include "host/model/read_mesh.hpp"
#include "tests/points/shapes.hpp"
#include "tests/scale.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::join_seams_test {
namespace {

using geometry::Point;
using model::Mesh;

class JoinSeams : public ::testing::Test {
 protected:
  /// Writes each triangle with its own corners, each moved by up to `shift`, and reads it.
  Mesh read_shifted(const Mesh& mesh, double shift, std::mt19937& random) {
    std::uniform_real_distribution<double> move(-shift, shift);
    std::string text;
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t vertex : triangle) {
        const Point& p = mesh.vertices[vertex];
        text += fmt::format("v {:.17g} {:.17g} {:.17g}\n", p.x + move(random), p.y + move(random),
                            p.z + move(random));
      }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
      text += fmt::format("f {} {} {}\n", 3 * i + 1, 3 * i + 2, 3 * i + 3);
    return model::read_mesh(folder_.write("a.obj", text));
  }

  const test::TemporaryFolder folder_;
};

TEST_F(JoinSeams, MeshesOpenedByRoundingAreClosedAgain) {
  std::mt19937 random(5);
  constexpr double step = 1.2e-7;  // of single precision, relative
  for (int round = 0; round < test::scaled(40, 4); ++round) {
    const double size = std::pow(10.0, static_cast<double>(random() % 6) - 2);
    const Mesh mesh = round % 3 == 0   ? test::box(size / 2, size / 3, size / 5)
                      : round % 3 == 1 ? test::sphere(size / 2, 9, 12)
                                       : test::torus(size / 3, size / 6, 10, 8);
    const Mesh joined = read_shifted(mesh, 0.5 * step * size, random);
    EXPECT_TRUE(model::find_faults(joined).closed) << size;
    EXPECT_EQ(joined.vertices.size(), mesh.vertices.size());
    EXPECT_EQ(joined.triangles.size(), mesh.triangles.size());
    // A gap that people could have drawn stays.
    EXPECT_FALSE(model::find_faults(read_shifted(mesh, 1e-4 * size, random)).closed);
  }
}

TEST_F(JoinSeams, ASphereByAnglesIsClosed) {
  // The seam at 0 and 2 pi, and poles, by sines that are not 0.
  constexpr int around = 24, rings = 12;
  std::string text;
  const auto add = [&](int ring, int turn) {
    const double polar = std::numbers::pi * ring / rings,
                 angle = 2 * std::numbers::pi * turn / around;
    text += fmt::format("vertex {} {} {}\n", 5 * std::sin(polar) * std::cos(angle),
                        5 * std::sin(polar) * std::sin(angle), 5 * std::cos(polar));
  };
  std::string all = "solid a\n";
  for (int ring = 0; ring < rings; ++ring)
    for (int turn = 0; turn < around; ++turn)
      for (const bool lower : {false, true}) {
        text.clear();
        add(ring, turn);
        if (!lower) add(ring + 1, turn);
        add(ring + 1, turn + 1);
        if (lower) add(ring, turn + 1);
        all += "facet normal 0 0 0\nouter loop\n" + text + "endloop\nendfacet\n";
      }
  const Mesh mesh = model::read_mesh(folder_.write("s.stl", all + "endsolid a\n"));
  EXPECT_TRUE(model::find_faults(mesh).closed);
  EXPECT_EQ(mesh.vertices.size(), std::size_t{(rings - 1) * around + 2});
  EXPECT_EQ(mesh.triangles.size(), std::size_t{2 * around * (rings - 1)});
}

TEST(WidestGap, IsTheWidthOfTheSeamOrTheSideOfTheHole) {
  Mesh mesh = test::box(1, 1, 1);
  EXPECT_EQ(model::widest_gap_mm(mesh), 0);
  mesh.triangles.pop_back();
  EXPECT_NEAR(model::widest_gap_mm(mesh), 2, 1e-9);
  // The corners of one triangle moved apart.
  mesh = test::box(1, 1, 1);
  for (std::uint32_t& vertex : mesh.triangles.back()) {
    const Point p = mesh.vertices[vertex];
    vertex = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back({p.x, p.y + 0.003, p.z});
  }
  EXPECT_NEAR(model::widest_gap_mm(mesh), 0.003, 1e-9);
  std::vector<std::uint32_t> kept(mesh.triangles.size());
  EXPECT_EQ(model::join_seams(mesh, kept), 0u);
}

}  // namespace
}  // namespace lamplock::join_seams_test
