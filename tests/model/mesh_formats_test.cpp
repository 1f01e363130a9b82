// Properties of the mesh readers: colours, units, coordinates far from the origin.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "host/bytes.hpp"
#include "host/model/mesh_faults.hpp"
#include "host/model/read_mesh.hpp"
#include "host/model/transform.hpp"
#include "tests/damaged.hpp"
#include "tests/model/glb_file.hpp"
#include "tests/points/shapes.hpp"
#include "tests/scale.hpp"

namespace lamplock::mesh_formats {
namespace {

using geometry::Point;
using model::Mesh;
using model::read_mesh;
using test::error_of;
using test::TemporaryFolder;
using ::testing::HasSubstr;

Point cross(const Point& a, const Point& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

double area(const Point& a, const Point& b, const Point& c) {
  const Point n = cross({b.x - a.x, b.y - a.y, b.z - a.z}, {c.x - a.x, c.y - a.y, c.z - a.z});
  return std::hypot(n.x, n.y, n.z) / 2;
}

constexpr const char* two_squares =
    "v 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\nv 20 0 0\nv 20 10 0\n"
    "usemtl white\nf 1 2 3 4\nusemtl black\nf 2 5 6 3\n";

TEST(ReadObj, ColoursOfMaterialsAreBrightness) {
  const TemporaryFolder folder;
  folder.write("k d.mtl", "newmtl white\nKd 1 1 1\nnewmtl black\nKd 0.02 0.04 0.06\n");
  folder.write("grey.mtl", "newmtl black\nKd 0.5\n");
  const auto path = folder.write("a.obj", std::string("mtllib k d.mtl\n") + two_squares);
  const Mesh mesh = read_mesh(path);
  ASSERT_TRUE(mesh.brightness);
  EXPECT_NEAR(mesh.brightness->at(0, 0.2, 0.2), 1, 1e-6);
  EXPECT_NEAR(mesh.brightness->at(3, 0.2, 0.2), 0.299 * 0.02 + 0.587 * 0.04 + 0.114 * 0.06, 1e-6);
  // Several names on a line, one of which is missing; a grey of one number.
  const Mesh grey =
      read_mesh(folder.write("b.obj", std::string("mtllib none.mtl grey.mtl\n") + two_squares));
  ASSERT_TRUE(grey.brightness);
  EXPECT_THAT(grey.reader_warnings, ::testing::ElementsAre(HasSubstr("none.mtl cannot be opened")));
  EXPECT_NEAR(grey.brightness->at(0, 0.2, 0.2), 1, 1e-6);
  EXPECT_NEAR(grey.brightness->at(2, 0.2, 0.2), 0.5, 1e-6);
  EXPECT_FALSE(read_mesh(folder.write("c.obj", two_squares)).brightness);
}

/// Names of libraries may contain blanks; each that is missing gives one warning.
TEST(ReadObj, NamesOfLibrariesMayContainBlanks) {
  const TemporaryFolder folder;
  folder.write("k d.mtl", "newmtl white\nKd 1 1 1\n");
  folder.write("grey.mtl", "newmtl black\nKd 0.5\n");
  const auto warnings = [&](const std::string& names) {
    return read_mesh(folder.write("a.obj", "mtllib " + names + "\n" + two_squares)).reader_warnings;
  };
  using ::testing::ElementsAre;
  EXPECT_THAT(warnings("no such.mtl"), ElementsAre(HasSubstr("no such.mtl cannot be opened")));
  EXPECT_THAT(warnings("no such file"), ElementsAre(HasSubstr("no such file cannot be opened")));
  EXPECT_THAT(warnings("no such.mtl none.mtl"),
              ElementsAre(HasSubstr("no such.mtl cannot"), HasSubstr("none.mtl cannot")));
  EXPECT_THAT(warnings("no such.mtl grey.mtl"), ElementsAre(HasSubstr("no such.mtl cannot")));
  EXPECT_THAT(warnings("grey.mtl k d.mtl"), ElementsAre());
}

/// The weight of a rational curve has no effect on faces.
TEST(ReadObj, ColoursOfVerticesCountAndWeightsDoNot) {
  const TemporaryFolder folder;
  const Mesh mesh =
      read_mesh(folder.write("a.obj", "v 0 0 0\nv 4 0 0 2\nv 0 1 0 0 1 0\nf 1 2 3\n"));
  EXPECT_EQ(mesh.vertices[1], (Point{4, 0, 0}));
  ASSERT_TRUE(mesh.brightness);
  EXPECT_NEAR(mesh.brightness->at(0, 0, 0), 1, 1e-6);
  EXPECT_NEAR(mesh.brightness->at(0, 0, 1), 0.587, 1e-6);
}

TEST(ReadPly, ColoursOfFacesAreBrightness) {
  const TemporaryFolder folder;
  const Mesh mesh = read_mesh(
      folder.write("a.ply",
                   "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\n"
                   "property double z\nelement face 2\nproperty uchar red\nproperty uchar green\n"
                   "property uchar blue\nproperty list uchar int vertex_indices\nend_header\n"
                   "0 0 0\n1 0 0\n1 1 0\n0 1 0\n255 0 0 3 0 1 2\n0 0 255 4 3 2 1 0\n"));
  ASSERT_TRUE(mesh.brightness);
  ASSERT_EQ(mesh.triangles.size(), 3u);
  EXPECT_NEAR(mesh.brightness->at(0, 0.3, 0.3), 0.299, 1e-6);
  EXPECT_NEAR(mesh.brightness->at(1, 0.3, 0.3), 0.114, 1e-6);
  EXPECT_NEAR(mesh.brightness->at(2, 0.3, 0.3), 0.114, 1e-6);
}

/// A binary STL whose facets have these attributes.
std::string stl_of(const Mesh& mesh, const std::string& header, std::uint16_t attribute) {
  std::string bytes = header;
  bytes.resize(80, ' ');
  append(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    bytes.append(12, '\0');
    for (const auto v : t)
      for (const double c : {mesh.vertices[v].x, mesh.vertices[v].y, mesh.vertices[v].z})
        append(bytes, static_cast<float>(c));
    append(bytes, attribute);
  }
  return bytes;
}

TEST(ReadStl, ColoursOfFacetsAreBrightness) {
  const TemporaryFolder folder;
  const Mesh box = test::box(1, 1, 1);
  const auto light = [&](const std::string& header, std::uint16_t attribute) {
    const Mesh mesh = read_mesh(folder.write("a.stl", stl_of(box, header, attribute)));
    return mesh.brightness ? mesh.brightness->at(0, 0.2, 0.2) : -1;
  };
  EXPECT_EQ(light("", 0x1F), -1);
  EXPECT_NEAR(light("", 0x801F), 0.114, 1e-6);       // VisCAM: blue
  EXPECT_NEAR(light("COLOR=1", 0x1F), 0.299, 1e-6);  // Magics: red
  EXPECT_EQ(light("COLOR=1", 0x801F), -1);
}

/// Texts of one body in every format whose numbers are text or double.
std::vector<std::pair<std::string, std::string>> exact_files(const Mesh& mesh) {
  std::string obj, stl = "solid a\n", ply, doubles;
  ply = fmt::format(
      "element vertex {}\nproperty double x\nproperty double y\nproperty double z\nelement face "
      "{}\nproperty list uchar int vertex_indices\nend_header\n",
      mesh.vertices.size(), mesh.triangles.size());
  doubles = "ply\nformat binary_little_endian 1.0\n" + ply;
  ply = "ply\nformat ascii 1.0\n" + ply;
  for (const Point& v : mesh.vertices) {
    obj += fmt::format("v {} {} {}\n", v.x, v.y, v.z);
    ply += fmt::format("{} {} {}\n", v.x, v.y, v.z);
    for (const double c : {v.x, v.y, v.z}) append(doubles, c);
  }
  for (const auto& t : mesh.triangles) {
    obj += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    ply += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
    doubles += '\3';
    for (const std::uint32_t v : t) append(doubles, static_cast<std::int32_t>(v));
    stl += "facet normal 0 0 0\nouter loop\n";
    for (const auto v : t)
      stl += fmt::format("vertex {} {} {}\n", mesh.vertices[v].x, mesh.vertices[v].y,
                         mesh.vertices[v].z);
    stl += "endloop\nendfacet\n";
  }
  return {{"a.obj", obj}, {"a.stl", stl + "endsolid a\n"}, {"a.ply", ply}, {"b.ply", doubles}};
}

TEST(ReadMesh, ObjectsFarFromTheOriginKeepTheirShape) {
  const TemporaryFolder folder;
  constexpr double far = 5.8e6;
  const Mesh near = test::torus(10, 3, 24, 12, 0.1);
  const Mesh mesh = model::transformed(near, geometry::moved(far, -far, far / 2));
  for (const auto& [name, bytes] : exact_files(mesh)) {
    const Mesh read = read_mesh(folder.write(name, bytes));
    EXPECT_TRUE(read.reader_warnings.empty()) << name;
    EXPECT_TRUE(test::is_closed(read)) << name;
    double deviation = 0;
    for (const Point& v : read.vertices) {
      const double ring = std::hypot(v.x - far, v.y + far) - 10;
      deviation = std::max(deviation, std::abs(std::hypot(ring, v.z - far / 2) - 3));
    }
    EXPECT_LT(deviation, 1e-8) << name;
  }
  const Mesh lost = read_mesh(folder.write("c.stl", stl_of(mesh, "", 0)));
  ASSERT_EQ(lost.reader_warnings.size(), 1u);
  EXPECT_THAT(lost.reader_warnings[0], HasSubstr("single precision, in steps of 0.5,"));
  EXPECT_TRUE(read_mesh(folder.write("d.stl", stl_of(near, "", 0))).reader_warnings.empty());
}

using mesh_files::glb_of;
using nlohmann::json;

TEST(ReadGlb, MetresWithYUpBecomeMillimetresWithZUp) {
  const TemporaryFolder folder;
  const Mesh read = read_mesh(folder.write("a.glb", glb_of(test::box(0.01, 0.02, 0.03))));
  const auto box = model::bounds(read.vertices);
  EXPECT_NEAR(box.high.x, 10, 1e-5);
  EXPECT_NEAR(box.high.z, 20, 1e-5);
  EXPECT_NEAR(box.high.y, 30, 1e-5);
  EXPECT_TRUE(test::is_closed(read));
  EXPECT_FALSE(model::find_faults(read).inside_out);
  EXPECT_FALSE(read.brightness);
}

TEST(ReadGlb, NodesMoveTurnAndMirror) {
  const TemporaryFolder folder;
  const double half = std::sqrt(0.5);
  const Mesh read = read_mesh(
      folder.write("a.glb", glb_of(test::box(1, 2, 3), [&](json& d) {
                     d["nodes"] = json::parse(R"([{"children": [1, 2], "translation": [100, 0, 0]},
      {"mesh": 0, "scale": [-1, 1, 1]}, {"mesh": 0, "matrix":
      [2,0,0,0, 0,1,0,0, 0,0,1,0, 0,50,0,1]}])");
                     d["nodes"][1]["rotation"] = {0, 0, half, half};  // a quarter turn about z
                   })));
  EXPECT_EQ(read.triangles.size(), 24u);
  EXPECT_TRUE(test::is_closed(read));
  EXPECT_FALSE(model::find_faults(read).inside_out);
  const auto box = model::bounds(read.vertices);
  EXPECT_NEAR(box.low.x, 98'000, 0.01);  // the turned one is 2 wide, the other 2 x 1
  EXPECT_NEAR(box.high.x, 102'000, 0.01);
  EXPECT_NEAR(box.low.z, -1000, 0.01);
  EXPECT_NEAR(box.high.z, 52'000, 0.01);
}

TEST(ReadGlb, MirroredNodesStayOutsideOut) {
  const TemporaryFolder folder;
  const Mesh read = read_mesh(folder.write("a.glb", glb_of(test::box(1, 2, 3), [](json& d) {
                                             d["nodes"][0]["scale"] = {-1, 1, 1};
                                           })));
  EXPECT_TRUE(test::is_closed(read));
  EXPECT_FALSE(model::find_faults(read).inside_out);
}

TEST(ReadGlb, StripsFansAndFactorsAreRead) {
  const TemporaryFolder folder;
  Mesh square;
  square.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  const auto of_mode = [&](int mode, std::vector<std::array<std::uint32_t, 3>> indices) {
    square.triangles = std::move(indices);
    return read_mesh(folder.write(
        "a.glb", glb_of(square, [&](json& d) {
          d["meshes"][0]["primitives"][0]["mode"] = mode;
          d["meshes"][0]["primitives"][0]["material"] = 0;
          d["accessors"][1]["count"] = mode == 4 ? 6 : 4;
          d["materials"] =
              json::parse(R"([{"pbrMetallicRoughness": {"baseColorFactor": [0.2, 0.2, 0.2, 1]}}])");
        })));
  };
  for (const Mesh& read : {of_mode(4, {{0, 1, 2}, {2, 1, 3}}), of_mode(5, {{0, 1, 2}, {3, 0, 0}}),
                           of_mode(6, {{0, 1, 3}, {2, 0, 0}})}) {
    ASSERT_EQ(read.triangles.size(), 2u);
    EXPECT_EQ(model::find_faults(read).turned_edges.count, 0u);
    double sum = 0;
    for (const auto& t : read.triangles)
      sum += area(read.vertices[t[0]], read.vertices[t[1]], read.vertices[t[2]]);
    EXPECT_NEAR(sum, 1e6, 1);
    ASSERT_TRUE(read.brightness);
    EXPECT_NEAR(read.brightness->at(1, 0.3, 0.3), std::pow(0.2, 1 / 2.2), 1e-6);
  }
}

TEST(ReadGlb, CopiesAndExtensionsAreBounded) {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::function<void(json&)>& change) {
    const auto path = folder.write("a.glb", glb_of(test::box(1, 1, 1), change));
    return error_of([&] { read_mesh(path); });
  };
  EXPECT_THAT(refusal([](json& d) { d["extensionsRequired"] = {"KHR_draco_mesh_compression"}; }),
              HasSubstr("'KHR_draco_mesh_compression'"));
  EXPECT_THAT(refusal([](json& d) {
                d["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
                d["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = json::object();
              }),
              HasSubstr("it repeats a mesh by the extension 'EXT_mesh_gpu_instancing'"));
  EXPECT_THAT(refusal([](json& d) {
                for (int i = 0; i < 1000; ++i) d["scenes"][0]["nodes"].push_back(0);
                auto& primitives = d["meshes"][0]["primitives"];
                primitives[0]["mode"] = 0;  // points
                for (int i = 0; i < 1000; ++i) primitives.push_back(primitives[0]);
              }),
              HasSubstr("nodes and primitives"));
  EXPECT_THAT(refusal([](json& d) { d["nodes"][0]["mesh"] = -1; }), HasSubstr("names mesh -1"));
  EXPECT_THAT(refusal([](json& d) { d["accessors"][0]["count"] = 7; }),
              HasSubstr("names vertex 7 of 7"));
  EXPECT_THAT(refusal([](json& d) { d["nodes"][0]["scale"] = {1, 1}; }), HasSubstr("3 numbers"));
  EXPECT_THAT(refusal([](json& d) { d["nodes"][0]["scale"] = {1, 1, 1e308}; }), HasSubstr("inf"));
}

/// Replaces, removes, repeats and inserts parts.
std::string mutated(std::string bytes, std::mt19937_64& random) {
  static const std::vector<std::string> words{
      "-1", "0", "4294967296", "1e308", "nan", "f 1 2 3\n", "\\\n", "[", "{}", "\n", "vt", "/"};
  bytes = test::damaged(std::move(bytes), test::any_byte(), random);
  for (auto changes = random() % 3; changes > 0 && !bytes.empty(); --changes) {
    const std::size_t at = random() % bytes.size(), length = random() % 40;
    switch (random() % 3) {
      case 0:
        bytes.erase(at, length);
        break;
      case 1:
        bytes.insert(at, bytes.substr(random() % bytes.size(), length));
        break;
      default:
        bytes.insert(at, words[random() % words.size()]);
    }
  }
  return bytes.empty() ? "x" : bytes;
}

TEST(ReadMesh, MutatedFilesAreReadOrRefused) {
  const TemporaryFolder folder;
  const Mesh mesh = test::torus(10, 3, 5, 4);
  auto files = exact_files(mesh);
  files.push_back({"c.stl", stl_of(mesh, "COLOR=1", 0x1234)});
  files.push_back({"b.obj", std::string("mtllib b.mtl\nvt 0 0\nvt 1 1\n") + two_squares +
                                "f 1/1 2/2 5/1 6/-1 3//1 4\nv 1 2 3 0.1 0.2 0.3\n"});
  files.push_back(
      {"c.ply",
       "ply\nformat ascii 1.0\ncomment TextureFile p.png\nelement vertex 4\nproperty float x\n"
       "property float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
       "property uchar blue\nproperty float s\nproperty float t\nelement face 2\n"
       "property list uchar int vertex_indices\nproperty list uchar float texcoord\n"
       "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
       "0 0 0 1 2 3 0 0\n1 0 0 4 5 6 1 0\n1 1 0 7 8 9 1 1\n0 1 0 1 1 1 0 1\n"
       "4 0 1 2 3 8 0 0 1 0 1 1 0 1 255 0 0\n3 0 1 2 0 1 2 3\n"});
  files.push_back({"a.glb", glb_of(mesh, [](json& d) {
                     d["nodes"] = json::parse(
                         R"([{"children": [1], "rotation": [0, 0, 0, 1]}, {"mesh": 0}])");
                     d["meshes"][0]["primitives"][0]["material"] = 0;
                     d["materials"] = json::parse(R"([{"pbrMetallicRoughness":
                       {"baseColorFactor": [1, 1, 1, 1], "baseColorTexture": {"index": 0}}}])");
                     d["textures"] = json::parse(R"([{"source": 0}])");
                     d["images"] = json::parse(R"([{"bufferView": 0}])");
                   })});
  folder.write("b.mtl", "newmtl white\nKd 1 1 1\nmap_Kd none.png\nnewmtl black\nKd 0 0 0\n");
  std::mt19937_64 random(11);
  for (const auto& file : files) {
    const auto& name = file.first;
    const auto& bytes = file.second;
    ASSERT_FALSE(read_mesh(folder.write(name, bytes)).triangles.empty()) << name;
    for (int i = 0; i < test::scaled(100, 10); ++i) {
      test::expect_read_or_refused([&] {
        const Mesh read = model::decode_mesh(folder.file(name), mutated(bytes, random));
        EXPECT_FALSE(read.triangles.empty());
        for (const auto& t : read.triangles)
          EXPECT_LT(std::max({t[0], t[1], t[2]}), read.vertices.size());
        if (read.brightness) {
          for (std::size_t t = 0; t < read.triangles.size(); ++t) read.brightness->at(t, 0.3, 0.3);
        }
      });
    }
  }
}

}  // namespace
}  // namespace lamplock::mesh_formats
