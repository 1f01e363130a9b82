// PLY files without faces: strips of triangles, edges alone.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <variant>
#include <vector>

#include "host/bytes.hpp"
#include "host/model/input.hpp"
#include "host/model/mesh_faults.hpp"
#include "host/model/read_mesh.hpp"
#include "host/model/read_points.hpp"
#include "tests/points/shapes.hpp"

namespace lamplock::ply_strips {
namespace {

using geometry::Point;
using model::Mesh;
using model::read_mesh;
using test::error_of;
using test::TemporaryFolder;
using ::testing::HasSubstr;

constexpr int rings = 9, sides = 6;

/// Vertices of a torus.
std::vector<Point> torus_vertices() {
  std::vector<Point> vertices;
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < sides; ++j) {
      const double a = 2 * std::numbers::pi * i / rings, b = 2 * std::numbers::pi * j / sides;
      const double r = 10 + 3 * std::cos(b);
      vertices.push_back({r * std::cos(a), r * std::sin(a), 3 * std::sin(b)});
    }
  return vertices;
}

/// One strip round each ring of the torus, with -1 between them.
std::vector<std::int32_t> torus_strips() {
  std::vector<std::int32_t> strips;
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j <= sides; ++j)
      for (const int ring : {i, i + 1}) strips.push_back(ring % rings * sides + j % sides);
    strips.push_back(-1);
  }
  return strips;
}

std::string header_of(const std::string& format, std::size_t vertices, const std::string& more) {
  return fmt::format(
      "ply\nformat {} 1.0\nelement vertex {}\nproperty double x\nproperty double y\n"
      "property double z\n{}end_header\n",
      format, vertices, more);
}

constexpr const char* strip_element = "element tristrips 1\nproperty list int int vertex_indices\n";

std::string text_of(const std::vector<Point>& vertices, const std::vector<std::int32_t>& strips) {
  std::string text = header_of("ascii", vertices.size(), strip_element);
  for (const Point& v : vertices) text += fmt::format("{} {} {}\n", v.x, v.y, v.z);
  text += std::to_string(strips.size());
  for (const std::int32_t index : strips) text += fmt::format(" {}", index);
  return text + "\n";
}

std::string little_endian_of(const std::vector<Point>& vertices,
                             const std::vector<std::int32_t>& strips) {
  std::string bytes = header_of("binary_little_endian", vertices.size(), strip_element);
  for (const Point& v : vertices)
    for (const double c : {v.x, v.y, v.z}) append(bytes, c);
  append(bytes, static_cast<std::int32_t>(strips.size()));
  for (const std::int32_t index : strips) append(bytes, index);
  return bytes;
}

TEST(ReadPly, StripsOfTrianglesAreRead) {
  const TemporaryFolder folder;
  const auto vertices = torus_vertices();
  for (const std::string& bytes :
       {text_of(vertices, torus_strips()), little_endian_of(vertices, torus_strips())}) {
    const model::Input read = model::read_input(folder.write("a.ply", bytes));
    ASSERT_TRUE(std::holds_alternative<Mesh>(read));
    const Mesh& mesh = std::get<Mesh>(read);
    EXPECT_EQ(mesh.triangles.size(), 2u * rings * sides);
    EXPECT_TRUE(test::is_closed(mesh));
    EXPECT_EQ(model::find_faults(mesh).turned_edges.count, 0u);
    EXPECT_THAT(error_of([&] { model::read_point_list(folder.file("a.ply")); }),
                HasSubstr("is a mesh"));
  }
}

TEST(ReadPly, StripsBeginWithTheirOwnWinding) {
  const TemporaryFolder folder;
  // The first strip has one triangle and no pair; 0 0 repeats a corner and has no area.
  const Mesh mesh =
      read_mesh(folder.write("a.ply", text_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}},
                                              {0, 1, 2, -1, -1, 3, -1, 1, 3, 2, -1, 0, 0, 1})));
  ASSERT_EQ(mesh.triangles.size(), 2u);
  for (const auto& t : mesh.triangles) {
    const Point &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    EXPECT_GT((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x), 0);
  }
}

TEST(ReadPly, StripsWithVerticesThatDoNotExistAreRefused) {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::vector<std::int32_t>& strips) {
    const auto file = folder.write("a.ply", text_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, strips));
    return error_of([&] { model::read_input(file); });
  };
  EXPECT_THAT(refusal({0, 1, 3}), HasSubstr("tristrips 0 names vertex 3 of 3"));
  EXPECT_THAT(refusal({0, 1, -2}), HasSubstr("names vertex -2"));
  EXPECT_THAT(refusal({0, 1, -1, 2}), HasSubstr("no triangle"));
}

TEST(ReadPly, EdgesAloneAreRefused) {
  const TemporaryFolder folder;
  const std::string edges = "element edge 2\nproperty int vertex1\nproperty int vertex2\n";
  const std::string data = "0 0 0\n1 0 0\n0 1 0\n0 1\n1 2\n";
  for (const std::string& more :
       {edges, "element face 0\nproperty list uchar int vertex_index\n" + edges}) {
    const auto file = folder.write("a.ply", header_of("ascii", 3, more) + data);
    for (const std::string& message :
         {error_of([&] { model::read_input(file); }),
          error_of([&] { model::read_point_list(file); }), error_of([&] { read_mesh(file); })})
      EXPECT_THAT(message, HasSubstr("it has 2 edges and no faces"));
  }
  const std::string face = "element face 1\nproperty list uchar int vertex_index\n";
  const auto file = folder.write("b.ply", header_of("ascii", 3, edges + face) + data + "3 0 1 2\n");
  EXPECT_EQ(read_mesh(file).triangles.size(), 1u);
}

}  // namespace
}  // namespace lamplock::ply_strips
