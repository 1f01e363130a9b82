#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <sstream>

#include "host/file.hpp"
#include "host/model/example.hpp"
#include "host/model/input.hpp"
#include "host/model/read_mesh.hpp"
#include "host/model/transform.hpp"
#include "tests/damaged.hpp"
#include "tests/points/shapes.hpp"
#include "tests/scale.hpp"

namespace lamplock {
namespace {

using model::Mesh;
using model::read_mesh;
using test::error_of;
using test::TemporaryFolder;
using ::testing::HasSubstr;

std::string obj_of(const Mesh& mesh) {
  std::ostringstream text;
  text.precision(9);
  for (const auto& v : mesh.vertices) text << "v " << v.x << ' ' << v.y << ' ' << v.z << '\n';
  for (const auto& t : mesh.triangles) {
    text << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
  }
  return text.str();
}

std::string ascii_stl_of(const Mesh& mesh) {
  std::ostringstream text;
  text.precision(9);
  text << "solid thing\n";
  for (const auto& t : mesh.triangles) {
    text << "facet normal 0 0 1\n outer loop\n";
    for (const auto i : t) {
      const auto& v = mesh.vertices[i];
      text << "  vertex " << v.x << ' ' << v.y << ' ' << v.z << '\n';
    }
    text << " endloop\nendfacet\n";
  }
  text << "endsolid thing\n";
  return text.str();
}

std::string ascii_ply_of(const Mesh& mesh) {
  std::ostringstream text;
  text.precision(9);
  text << "ply\nformat ascii 1.0\nelement vertex " << mesh.vertices.size()
       << "\nproperty float x\nproperty float y\nproperty float z\nelement face "
       << mesh.triangles.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const auto& v : mesh.vertices) text << v.x << ' ' << v.y << ' ' << v.z << '\n';
  for (const auto& t : mesh.triangles) text << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
  return text.str();
}

template <class Value>
void append(std::string& bytes, Value value, bool big_endian) {
  std::array<char, sizeof(Value)> raw{};
  std::memcpy(raw.data(), &value, sizeof(Value));
  if (big_endian == (std::endian::native == std::endian::little)) {
    std::reverse(raw.begin(), raw.end());
  }
  bytes.append(raw.data(), raw.size());
}

std::string binary_ply_of(const Mesh& mesh, bool big_endian) {
  std::ostringstream header;
  header << "ply\nformat binary_" << (big_endian ? "big" : "little")
         << "_endian 1.0\nelement vertex " << mesh.vertices.size()
         << "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
         << "element face " << mesh.triangles.size()
         << "\nproperty list uchar int vertex_indices\nend_header\n";
  std::string bytes = header.str();
  for (const auto& v : mesh.vertices) {
    for (const double c : {v.x, v.y, v.z}) append(bytes, static_cast<float>(c), big_endian);
    bytes.push_back('\x7F');
  }
  for (const auto& t : mesh.triangles) {
    bytes.push_back('\x03');
    for (const auto i : t) append(bytes, static_cast<std::int32_t>(i), big_endian);
  }
  return bytes;
}

std::string binary_stl_of(const Mesh& mesh, const TemporaryFolder& folder) {
  model::write_stl(folder.file("written.stl"), mesh);
  return read_file(folder.file("written.stl"));
}

/// Expects the same closed body for every format, to the formats' single precision.
void expect_torus(const Mesh& mesh) {
  EXPECT_EQ(mesh.vertices.size(), 24u * 12u);
  EXPECT_EQ(mesh.triangles.size(), 2u * 24u * 12u);
  EXPECT_TRUE(test::is_closed(mesh));
  for (const auto& v : mesh.vertices) {
    EXPECT_NEAR(std::hypot(std::hypot(v.x, v.y) - 10, v.z), 3, 1e-5);
  }
}

TEST(ReadMesh, EveryFormatGivesTheSameClosedBody) {
  const TemporaryFolder folder;
  const Mesh mesh = test::torus(10, 3, 24, 12, 0.1);
  expect_torus(read_mesh(folder.write("a.obj", obj_of(mesh))));
  expect_torus(read_mesh(folder.write("a.stl", ascii_stl_of(mesh))));
  expect_torus(read_mesh(folder.write("b.STL", binary_stl_of(mesh, folder))));
  expect_torus(read_mesh(folder.write("a.ply", ascii_ply_of(mesh))));
  expect_torus(read_mesh(folder.write("b.ply", binary_ply_of(mesh, false))));
  expect_torus(read_mesh(folder.write("c.ply", binary_ply_of(mesh, true))));
}

TEST(ReadMesh, ObjGroupsAreJoinedAndPolygonsTriangulated) {
  const TemporaryFolder folder;
  const Mesh mesh = read_mesh(folder.write("a.obj",
                                           "# two parts, one quad, negative and split indices\n"
                                           "o one\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
                                           "f 1 2 \\\n 3 4\no two\nv 0 0 1\nv 1 0 1\nv 0 1 1\n"
                                           "vn 0 0 1\nf -3//1 -2//1 -1//1\n"));
  EXPECT_EQ(mesh.triangles.size(), 3u);
  EXPECT_EQ(mesh.vertices.size(), 7u);
}

TEST(ReadMesh, BytesAfterABinaryStlAreIgnored) {
  const TemporaryFolder folder;
  const std::string bytes = binary_stl_of(test::torus(10, 3, 24, 12), folder);
  expect_torus(read_mesh(folder.write("a.stl", bytes + "exported with care")));
}

TEST(ReadMesh, BinaryStlThatBeginsWithSolidIsBinary) {
  const TemporaryFolder folder;
  std::string bytes = binary_stl_of(test::torus(10, 3, 24, 12), folder);
  bytes.replace(0, 6, "solid ");
  expect_torus(read_mesh(folder.write("a.stl", bytes)));
}

TEST(ReadMesh, EveryTruncationOfStlAndPlyIsRefused) {
  const TemporaryFolder folder;
  const Mesh mesh = test::torus(10, 3, 5, 4);
  const std::vector<std::pair<std::string, std::string>> files{
      {"a.stl", binary_stl_of(mesh, folder)},
      {"b.stl", ascii_stl_of(mesh)},
      {"a.ply", ascii_ply_of(mesh)},
      {"b.ply", binary_ply_of(mesh, false)}};
  for (const auto& [name, bytes] : files) {
    // The last line of the text formats may lack its line end and name, but no more.
    const std::size_t spare = name == "b.stl" ? 7 : name == "a.ply" ? 2 : 0;
    const std::size_t stride = bytes.size() / 60 + 1;
    for (std::size_t size = 0; size + spare < bytes.size(); size += stride) {
      const auto path = folder.write(name, bytes.substr(0, size));
      EXPECT_THAT(error_of([&] { read_mesh(path); }), HasSubstr(name)) << size;
    }
    const auto path = folder.write(name, bytes.substr(0, bytes.size() - spare - 1));
    EXPECT_THAT(error_of([&] { read_mesh(path); }), HasSubstr(name));
  }
}

TEST(ReadMesh, CutLinesOfObjAreRefused) {
  const TemporaryFolder folder;
  const std::string whole = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  EXPECT_EQ(read_mesh(folder.write("a.obj", whole)).triangles.size(), 1u);
  for (const std::size_t size : {30u, 29u, 28u, 27u, 22u, 20u, 16u, 8u}) {
    const auto path = folder.write("a.obj", whole.substr(0, size));
    EXPECT_NE(error_of([&] { read_mesh(path); }), "") << size;
  }
}

TEST(ReadMesh, VerticesThatAreNotFiniteAreNamed) {
  const TemporaryFolder folder;
  const Mesh good = test::torus(10, 3, 5, 4);
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Mesh mesh = good;
    mesh.vertices[7].y = bad;
    const auto expect_named = [&](const std::string& name, const std::string& bytes) {
      const auto path = folder.write(name, bytes);
      EXPECT_THAT(error_of([&] { read_mesh(path); }), HasSubstr("vertex 7 is")) << name;
    };
    expect_named("a.obj", obj_of(mesh));
    expect_named("a.ply", ascii_ply_of(mesh));
    expect_named("b.ply", binary_ply_of(mesh, true));
    mesh.triangles = {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}};
    expect_named("a.stl", ascii_stl_of(mesh));
    expect_named("b.stl", binary_stl_of(mesh, folder));
  }
}

TEST(ReadMesh, BrokenFilesAreRefusedWithAReason) {
  const TemporaryFolder folder;
  const auto message = [&](const std::string& name, const std::string& bytes) {
    const auto path = folder.write(name, bytes);
    return error_of([&] { read_mesh(path); });
  };
  EXPECT_THAT(error_of([&] { read_mesh(folder.file("none.stl")); }), HasSubstr("no such file"));
  EXPECT_THAT(error_of([&] { read_mesh(folder.file("")); }), HasSubstr("not a file"));
  EXPECT_THAT(message("a.stl", ""), HasSubstr("empty"));
  EXPECT_THAT(message("a.stl", "solid a\nendsolid a\n"), HasSubstr("a.stl"));
  EXPECT_THAT(message("a.stl", std::string(84, '\0')), HasSubstr("a.stl"));
  EXPECT_THAT(message("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"), HasSubstr("a.obj"));
  EXPECT_THAT(message("a.obj", "v 0 0 0\nf 1 1 1\n"), HasSubstr("no triangle"));
  EXPECT_THAT(message("a.obj", "v 0 0 0\nf 1 2 3\n"), HasSubstr("line 2"));
  EXPECT_THAT(message("a.obj", "v 0 0 0\nf -1 -2 -3\n"), HasSubstr("line 2"));
  EXPECT_THAT(message("a.obj", "v 0 0 zero\n"), HasSubstr("line 1"));
  EXPECT_THAT(message("a.obj", "v 0 0 1e999\n"), HasSubstr("line 1"));
  EXPECT_THAT(message("a.ply", "plyx\n"), HasSubstr("line 1"));
  EXPECT_THAT(message("a.ply", "ply\nformat ascii 1.0\nelement vertex 99999999999\nend_header\n"),
              HasSubstr("line 3"));
  EXPECT_THAT(message("a.ply",
                      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float "
                      "y\nproperty float z\nelement face 1\nproperty list uchar int "
                      "vertex_indices\nend_header\n0 0 0\n3 0 0 9\n"),
              HasSubstr("names vertex 9"));
  const std::string triangle =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  EXPECT_THAT(message("a.ply", triangle + "0 0 0\n1 0 0\n0 1 0\n0\n"), HasSubstr("no corners"));
  // The library reads line by line: a missing number must not be taken from the next line.
  EXPECT_THAT(message("a.ply", triangle + "0 0 0\n1 0\n0 1 0 3\n3 0 1 2\n"), HasSubstr("vertex"));
  EXPECT_THAT(message("a.ply", triangle + "0 0 0\n1 0 0 7\n0 1 0\n3 0 1 2\n"), HasSubstr("vertex"));
  EXPECT_THAT(message("a.step", "ISO-10303-21;"), HasSubstr("not a mesh format"));
}

// Damaged files are either read or refused in one line.
TEST(ReadMesh, DamagedFilesAtWorstFail) {
  const TemporaryFolder folder;
  const Mesh mesh = test::torus(10, 3, 5, 4);
  const std::vector<std::pair<std::string, std::string>> files{
      {"a.stl", binary_stl_of(mesh, folder)},
      {"b.stl", ascii_stl_of(mesh)},
      {"a.obj", obj_of(mesh)},
      {"a.ply", ascii_ply_of(mesh)},
      {"b.ply", binary_ply_of(mesh, false)},
      {"c.ply", binary_ply_of(mesh, true)}};
  std::mt19937_64 random(20);
  for (int i = 0; i < test::scaled(600); ++i) {
    auto [name, bytes] = files[random() % files.size()];
    const std::uint64_t flips = 1 + random() % 4;
    for (std::uint64_t n = 0; n < flips; ++n) {
      bytes[random() % bytes.size()] = static_cast<char>(random() % 256);
    }
    if (random() % 4 == 0) bytes.resize(random() % bytes.size());
    const auto path = folder.write(name, bytes);
    test::expect_read_or_refused([&] {
      const Mesh read = read_mesh(path);
      EXPECT_FALSE(read.triangles.empty());
      for (const auto& t : read.triangles) {
        EXPECT_LT(std::max({t[0], t[1], t[2]}), read.vertices.size());
      }
    });
  }
}

TEST(Input, HasAKindForEveryExtension) {
  const TemporaryFolder folder;
  using model::InputKind;
  using model::may_hold;
  const std::pair<const char*, InputKind> kinds[]{
      {"a.STL", InputKind::mesh},    {"a.obj", InputKind::mesh},   {"a.3mf", InputKind::mesh},
      {"a.glb", InputKind::mesh},    {"a.ply", InputKind::mesh},   {"a.ply", InputKind::points},
      {"a.png", InputKind::bitmap},  {"a.bmp", InputKind::bitmap}, {"a.JPG", InputKind::bitmap},
      {"a.jpeg", InputKind::bitmap}, {"a.xyz", InputKind::points}, {"a.csv", InputKind::points},
      {"a.cad", InputKind::points},  {"a.dxf", InputKind::curves}, {"a.dxf", InputKind::points},
      {"a.svg", InputKind::curves}};
  for (const auto& [name, kind] : kinds) EXPECT_TRUE(may_hold(folder.write(name, "x"), kind));
  EXPECT_FALSE(may_hold(folder.file("a.STL"), InputKind::points));
  EXPECT_FALSE(may_hold(folder.file("a.dxf"), InputKind::mesh));
  EXPECT_EQ(model::extensions(InputKind::mesh), "stl, obj, ply, 3mf, glb");
  EXPECT_EQ(model::extensions(InputKind::points), "xyz, txt, csv, asc, cad, ply, dxf");
}

TEST(Input, OfPlyDependsOnTheFaces) {
  const TemporaryFolder folder;
  Mesh mesh = test::torus(10, 3, 5, 4);
  const model::Input with = model::read_input(folder.write("a.ply", ascii_ply_of(mesh)));
  ASSERT_TRUE(std::holds_alternative<Mesh>(with));
  EXPECT_EQ(std::get<Mesh>(with).triangles.size(), mesh.triangles.size());
  mesh.triangles.clear();
  const model::Input without = model::read_input(folder.write("b.ply", ascii_ply_of(mesh)));
  ASSERT_TRUE(std::holds_alternative<geometry::PointCloud>(without));
  EXPECT_EQ(std::get<geometry::PointCloud>(without).size(), mesh.vertices.size());
}

TEST(Input, RefusesUnknownExtensionsAndMissingFiles) {
  const TemporaryFolder folder;
  const std::string unknown = error_of([&] { model::read_input(folder.write("a.xyzzy", "x")); });
  EXPECT_THAT(unknown, HasSubstr("unknown kind of file '.xyzzy'"));
  EXPECT_THAT(unknown, HasSubstr("a drawing (dxf, svg, svgz), a picture (png, bmp, jpg, jpeg)"));
  EXPECT_THAT(error_of([&] { model::read_input(folder.file("none.stl")); }),
              HasSubstr("no such file"));
}

TEST(Input, NamesTheFormatToExportInsteadOfAForeignOne) {
  const TemporaryFolder folder;
  for (const auto& [name, instead] : std::vector<std::pair<std::string, std::string>>{
           {"a.dwg", "a DWG drawing, which is not read; save it as DXF"},
           {"a.AI", "save it as SVG"},
           {"a.step", "a STEP solid, which is not read; export a mesh (STL or 3MF, in mm)"},
           {"a.stp", "export a mesh"},
           {"a.iges", "export a mesh"},
           {"a.f3d", "export a mesh"},
           {"a.gltf", "export it as GLB"}}) {
    const std::string file = folder.write(name, "x");
    EXPECT_THAT(error_of([&] { model::read_input(file); }), HasSubstr(instead));
    EXPECT_FALSE(model::kind_of(name).has_value());
  }
}

TEST(Transform, CentresAndScalesByTheLongestSide) {
  Mesh mesh = test::box(3, 1, 2);
  for (auto& v : mesh.vertices) v = {v.x + 100, v.y - 7, v.z + 1};
  const auto box = model::bounds(model::centred_and_scaled(mesh, 30).vertices);
  EXPECT_NEAR(box.low.x, -15, 1e-12);
  EXPECT_NEAR(box.high.x, 15, 1e-12);
  EXPECT_NEAR(box.high.y, 5, 1e-12);
  EXPECT_NEAR(box.low.z, -10, 1e-12);
  EXPECT_NE(error_of([&] { model::centred_and_scaled(mesh, 0); }), "");
  EXPECT_NE(error_of([&] { model::centred_and_scaled({{{1, 1, 1}}, {}}, 10); }), "");
}

TEST(Transform, YUpBecomesZUpWithoutMirroring) {
  const Mesh mesh = model::y_up_to_z_up({{{1, 2, 3}}, {}});
  EXPECT_EQ(mesh.vertices[0], (geometry::Point{1, -3, 2}));
}

TEST(Example, IsClosedAndUnchangedByItsFile) {
  const TemporaryFolder folder;
  const Mesh mesh = model::example_model();
  EXPECT_TRUE(test::is_closed(mesh));
  EXPECT_NEAR(model::bounds(mesh.vertices).max_side(), 60, 1e-9);
  model::write_stl(folder.file("a.stl"), mesh);
  const Mesh read = read_mesh(folder.file("a.stl"));
  EXPECT_EQ(read.triangles.size(), mesh.triangles.size());
  EXPECT_TRUE(test::is_closed(read));
}

}  // namespace
}  // namespace lamplock
