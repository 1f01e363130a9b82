// What GLB files describe besides triangles: skins, morph targets, points and lines, sparse
// accessors, files without scenes.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "host/bytes.hpp"
#include "host/model/read_mesh.hpp"
#include "host/model/transform.hpp"
#include "tests/model/glb_file.hpp"
#include "tests/points/shapes.hpp"
#include "tests/scale.hpp"

namespace lamplock::glb_content {
namespace {

using geometry::Point;
using mesh_files::glb_of;
using model::Mesh;
using nlohmann::json;
using test::error_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class GlbContent : public ::testing::Test {
 protected:
  Mesh read(const std::function<void(json&)>& change, const std::string& more = "") const {
    return model::read_mesh(folder_.write("a.glb", glb_of(test::box(1, 2, 3), change, more)));
  }
  std::string refusal(const std::function<void(json&)>& change,
                      const std::string& more = "") const {
    return error_of([&] { read(change, more); });
  }

  const test::TemporaryFolder folder_;
};

TEST_F(GlbContent, SkinsAreNamed) {
  const auto skins = [&](unsigned count) {
    return read([&](json& d) {
             for (unsigned i = 0; i < 4; ++i) {
               d["nodes"][i] = {{"mesh", 0}, {"translation", {10 * i, 0, 0}}, {"skin", i % count}};
               d["scenes"][0]["nodes"][i] = i;
               d["skins"][i] = {{"joints", {0}}};
             }
           })
        .reader_warnings;
  };
  EXPECT_THAT(skins(1), ElementsAre(HasSubstr("1 skin not read: the mesh is in its rest pose")));
  EXPECT_THAT(skins(2), ElementsAre(HasSubstr("2 skins not read")));
}

TEST_F(GlbContent, MorphTargetsWithWeightsAreNamed) {
  const auto warnings = [&](const json& of_mesh, const json& of_node) {
    return read([&](json& d) {
             d["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", 0}}, {{"POSITION", 0}}};
             if (!of_mesh.is_null()) d["meshes"][0]["weights"] = of_mesh;
             if (!of_node.is_null()) d["nodes"][0]["weights"] = of_node;
           })
        .reader_warnings;
  };
  const auto named = ElementsAre(HasSubstr("morph targets of 1 shape not read"));
  EXPECT_THAT(warnings({0, 0.5}, {}), named);
  EXPECT_THAT(warnings({}, {1, 0}), named);
  EXPECT_THAT(warnings({0, 0}, {1, 0}), named);
  // Without weights the mesh has its base shape; weights of the node replace those of the mesh.
  EXPECT_THAT(warnings({}, {}), IsEmpty());
  EXPECT_THAT(warnings({0, 0}, {}), IsEmpty());
  EXPECT_THAT(warnings({1, 1}, {0, 0}), IsEmpty());
}

TEST_F(GlbContent, PointsAndLinesAreNamed) {
  const auto with_mode = [](int mode, bool alone) {
    return [mode, alone](json& d) {
      auto& primitives = d["meshes"][0]["primitives"];
      primitives.push_back(primitives[0]);
      primitives[1]["mode"] = mode;
      if (alone) primitives.erase(0);
    };
  };
  for (int mode = 0; mode < 4; ++mode) {
    const Mesh mesh = read(with_mode(mode, false));
    EXPECT_EQ(mesh.triangles.size(), 12u);
    EXPECT_THAT(mesh.reader_warnings, ElementsAre(HasSubstr("1 primitive of points or lines")));
    EXPECT_THAT(refusal(with_mode(mode, true)),
                HasSubstr("it has 1 primitive of points or lines and no triangles"));
  }
  EXPECT_THAT(refusal(with_mode(7, false)), HasSubstr("the mode 7"));
}

TEST_F(GlbContent, WithoutScenesAllRootsAreDrawn) {
  const Mesh mesh = read([](json& d) {
    d.erase("scenes");
    d["nodes"] = json::parse(R"([{"mesh": 0}, {"mesh": 0, "translation": [0, 20, 0]},
      {"children": [1], "translation": [0, 20, 0]}])");
  });
  EXPECT_EQ(mesh.triangles.size(), 24u);
  EXPECT_NEAR(model::bounds(mesh.vertices).high.z, 42'000, 0.01);
  EXPECT_THAT(refusal([](json& d) {
                d.erase("scenes");
                d["scene"] = 0;
              }),
              HasSubstr("names scene 0 of 0"));
}

/// Replaces `moved` corners of the positions of the box; the base is its own positions or zeros.
void make_sparse(json& d, std::size_t moved, std::uint64_t index_type, bool has_base) {
  const std::size_t index_bytes = index_type == 5121 ? 1 : index_type == 5123 ? 2 : 4;
  const std::size_t begin = d["bufferViews"][1]["byteOffset"].get<std::size_t>() +
                            d["bufferViews"][1]["byteLength"].get<std::size_t>();
  const std::size_t split = begin + moved * index_bytes, end = split + moved * 12;
  d["buffers"][0]["byteLength"] = end;
  d["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", begin}, {"byteLength", split - begin}});
  d["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", split}, {"byteLength", end - split}});
  d["accessors"][0]["sparse"] = {{"count", moved},
                                 {"indices", {{"bufferView", 2}, {"componentType", index_type}}},
                                 {"values", {{"bufferView", 3}}}};
  if (!has_base) d["accessors"][0].erase("bufferView");
}

template <class Index>
std::string sparse_numbers(const std::vector<std::uint32_t>& indices,
                           const std::vector<Point>& points) {
  std::string bytes;
  for (const std::uint32_t index : indices) append(bytes, static_cast<Index>(index));
  for (const Point& p : points)
    for (const double c : {p.x, p.y, p.z}) append(bytes, static_cast<float>(c));
  return bytes;
}

// Random corners of the box are moved; the triangles must be those of the moved box.
TEST_F(GlbContent, SparseAccessorsAreRead) {
  std::mt19937_64 random(5);
  for (int round = 0; round < test::scaled(60, 12); ++round) {
    const bool has_base = round % 2 == 0;
    Mesh expected = test::box(1, 2, 3);
    std::vector<std::uint32_t> indices;
    std::vector<Point> points;
    for (std::uint32_t i = 0; i < expected.vertices.size(); ++i) {
      if (!has_base && i != 3) expected.vertices[i] = {};
      // Corners at one place would be merged: without a base only one stays at zero.
      if (has_base ? test::below(random, 2) == 0 : i == 3) continue;
      const auto coordinate = [&] { return static_cast<double>(test::below(random, 1000)) + 5; };
      expected.vertices[i] = {coordinate(), coordinate(), coordinate()};
      indices.push_back(i);
      points.push_back(expected.vertices[i]);
    }
    if (!has_base) expected.vertices[3] = {};
    const std::uint64_t types[] = {5121, 5123, 5125};
    const std::uint64_t type = types[round / 2 % 3];
    const std::string more = type == 5121   ? sparse_numbers<std::uint8_t>(indices, points)
                             : type == 5123 ? sparse_numbers<std::uint16_t>(indices, points)
                                            : sparse_numbers<std::uint32_t>(indices, points);
    const Mesh mesh = read([&](json& d) { make_sparse(d, indices.size(), type, has_base); }, more);
    ASSERT_EQ(mesh.triangles.size(), expected.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (std::size_t i = 0; i < 3; ++i) {
        const Point& p = expected.vertices[expected.triangles[t][i]];
        const Point metres{1000 * p.x, -1000 * p.z, 1000 * p.y};  // y up becomes z up
        EXPECT_LT(test::distance(mesh.vertices[mesh.triangles[t][i]], metres), 1e-6);
      }
  }
}

TEST_F(GlbContent, DamagedSparseAccessorsAreRefused) {
  const std::vector<Point> points{{1, 2, 3}, {4, 5, 6}};
  const auto message = [&](const std::vector<std::uint32_t>& indices,
                           const std::function<void(json&)>& change) {
    return refusal(
        [&](json& d) {
          make_sparse(d, 2, 5123, false);
          change(d);
        },
        sparse_numbers<std::uint16_t>(indices, points));
  };
  const auto sparse = [](json& d) -> json& { return d["accessors"][0]["sparse"]; };
  EXPECT_THAT(message({3, 2}, [](json&) {}), HasSubstr("sparse indices out of order"));
  EXPECT_THAT(message({3, 3}, [](json&) {}), HasSubstr("sparse indices out of order"));
  EXPECT_THAT(message({3, 8}, [](json&) {}), HasSubstr("sparse indices out of order"));
  EXPECT_THAT(message({1, 2}, [&](json& d) { sparse(d)["count"] = 3; }), HasSubstr("beyond"));
  EXPECT_THAT(message({1, 2}, [&](json& d) { sparse(d)["count"] = 1ull << 62; }),
              HasSubstr("beyond"));
  EXPECT_THAT(message({1, 2}, [&](json& d) { sparse(d)["values"]["byteOffset"] = 1; }),
              HasSubstr("beyond"));
  EXPECT_THAT(message({1, 2}, [&](json& d) { sparse(d)["indices"]["componentType"] = 5126; }),
              HasSubstr("unknown type"));
  EXPECT_THAT(message({1, 2}, [&](json& d) { sparse(d)["values"].erase("bufferView"); }),
              HasSubstr("no sparse numbers"));
  EXPECT_THAT(message({1, 2}, [&](json& d) { sparse(d).erase("indices"); }),
              HasSubstr("wrong kind"));
  EXPECT_THAT(message({1, 2}, [](json& d) { d["accessors"][0]["count"] = 1ull << 40; }),
              HasSubstr("too many elements"));
  EXPECT_THAT(message({1, 2},
                      [](json& d) {
                        for (int i = 0; i < 1000; ++i) d["accessors"].push_back(d["accessors"][0]);
                      }),
              HasSubstr("repeats sparse numbers"));
}

}  // namespace
}  // namespace lamplock::glb_content
