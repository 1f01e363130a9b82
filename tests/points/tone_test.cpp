#include "host/points/tone.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

#include "host/file.hpp"
#include "host/model/read_mesh.hpp"
#include "tests/damaged.hpp"
#include "tests/points/picture_points.hpp"
#include "tests/points/sampling.hpp"
#include "tests/scale.hpp"

namespace lamplock {
namespace {

using geometry::PointCloud;
using model::Bitmap;
using model::Mesh;
using model::read_mesh;
using points::Plane;
using points::ToneCurve;
using test::error_of;
using test::picture_points;
using test::TemporaryFolder;
using ::testing::HasSubstr;

TEST(ToneCurve, IsAPowerBetweenLowestAndHighest) {
  const ToneCurve tone{.gamma = 2, .lowest = 0.2, .highest = 0.6};
  EXPECT_DOUBLE_EQ(tone.density(0), 0.2);
  EXPECT_DOUBLE_EQ(tone.density(0.5), 0.3);
  EXPECT_DOUBLE_EQ(tone.density(1), 0.6);
  EXPECT_DOUBLE_EQ(tone.density(7), 0.6);
  EXPECT_DOUBLE_EQ(tone.density(-1), 0.2);
  EXPECT_DOUBLE_EQ(tone.density(std::numeric_limits<double>::quiet_NaN()), 0.2);
  EXPECT_DOUBLE_EQ((ToneCurve{.gamma = 1, .invert = true}).density(0.3), 0.7);
  EXPECT_NEAR(ToneCurve{}.density(0.5), 0.287, 0.001);  // gamma 1.8
}

TEST(ToneCurve, InvalidCurvesAreRefused) {
  for (const ToneCurve& tone : {ToneCurve{.gamma = 0}, ToneCurve{.lowest = -0.1},
                                ToneCurve{.highest = 1.1}, ToneCurve{.lowest = 0.6, .highest = 0.5},
                                ToneCurve{.lowest = std::numeric_limits<double>::quiet_NaN()}}) {
    EXPECT_NE(error_of([&] { points::require_valid(tone, "tone"); }), "");
  }
}

Bitmap even_grey(int side, int grey) {
  return {side, side,
          std::vector<std::uint8_t>(static_cast<std::size_t>(side * side),
                                    static_cast<std::uint8_t>(grey))};
}

TEST(BitmapTone, ShareOfPointsFollowsTheCurve) {
  for (const double gamma : {1.0, 1.8}) {
    for (const int grey : {10, 60, 128, 200, 250}) {
      for (const bool invert : {false, true}) {
        const ToneCurve tone{.gamma = gamma};
        const PointCloud cloud = picture_points(even_grey(100, grey), 100,
                                                {.spacing_mm = 1, .invert = invert, .tone = tone});
        const double bright = grey / 255.0;
        EXPECT_NEAR(static_cast<double>(cloud.size()) / 10'000,
                    tone.density(invert ? bright : 1 - bright), 0.01)
            << grey << ' ' << gamma;
      }
    }
  }
}

TEST(BitmapTone, BlackIsFullAndWhiteIsEmptyBesideEachOther) {
  Bitmap halves = even_grey(40, 0);
  for (std::size_t i = 0; i < halves.grey.size(); ++i) {
    halves.grey[i] = i % 40 < 13 ? 0 : i % 40 < 27 ? 100 : 255;
  }
  const PointCloud cloud = picture_points(halves, 40, {.spacing_mm = 1, .tone = ToneCurve{}});
  int black = 0, white = 0;
  for (const auto& p : cloud) {
    black += p.x < -7 ? 1 : 0;
    white += p.x > 7 ? 1 : 0;
  }
  EXPECT_EQ(black, 13 * 40);
  EXPECT_EQ(white, 0);
}

TEST(BitmapTone, PointsOfAGreyAreSpreadAndLayersDiffer) {
  const points::BitmapOptions options{
      .spacing_mm = 1, .layers = 3, .layer_mm = 2, .tone = ToneCurve{.gamma = 1}};
  const PointCloud cloud = picture_points(even_grey(64, 191), 64, options);  // a quarter
  std::array<std::vector<std::pair<double, double>>, 3> layers;
  for (const auto& p : cloud) layers[static_cast<std::size_t>(p.z / 2 + 1)].emplace_back(p.x, p.y);
  EXPECT_NE(layers[0], layers[1]);
  EXPECT_NE(layers[1], layers[2]);
  for (const auto& layer : layers) {
    // Blue noise: squares of 8 x 8 contain 16 each with little deviation (random ones: 3.5).
    std::array<double, 64> squares{};
    for (const auto& [x, y] : layer) {
      ++squares[static_cast<std::size_t>((x + 32) / 8) +
                8 * static_cast<std::size_t>((y + 32) / 8)];
    }
    double deviation = 0;
    for (const double count : squares) deviation += (count - 16) * (count - 16) / 64;
    EXPECT_LT(std::sqrt(deviation), 2);
  }
  EXPECT_EQ(picture_points(even_grey(64, 191), 64, options), cloud);
  EXPECT_GE(test::min_square(cloud), 1 - 1e-12);
}

// Half grey by plain error diffusion is a chequerboard, in which defects are visible.
TEST(BitmapTone, HalfGreyIsNoChequerboard) {
  const PointCloud cloud =
      picture_points(even_grey(64, 127), 64, {.spacing_mm = 1, .tone = ToneCurve{.gamma = 1}});
  std::size_t beside = 0;
  for (std::size_t i = 1; i < cloud.size(); ++i) {
    if (test::distance(cloud[i - 1], cloud[i]) < 1.1) ++beside;
  }
  EXPECT_GT(static_cast<double>(beside) / static_cast<double>(cloud.size()), 0.1);
}

TEST(BitmapPoints, PlanesAreTheSamePictureRotated) {
  const Bitmap bitmap{2, 2, {0, 200, 10, 127}};
  const points::BitmapOptions options{.spacing_mm = 1, .layers = 2, .layer_mm = 3};
  const PointCloud upright = picture_points(bitmap, 2, options);
  for (const Plane plane : {Plane::xz, Plane::yz}) {
    const PointCloud turned = picture_points(bitmap, 2, options, plane);
    ASSERT_EQ(turned.size(), upright.size());
    for (std::size_t i = 0; i < turned.size(); ++i) {
      const auto& p = upright[i];
      EXPECT_EQ(turned[i], plane == Plane::xz ? (geometry::Point{p.x, p.z, p.y})
                                              : (geometry::Point{p.z, p.x, p.y}));
    }
  }
}

/// A PNG of grey values, rows from the top.
void write_png(const std::filesystem::path& path, int width, int height,
               const std::vector<std::uint8_t>& grey) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_GRAY;
  ASSERT_NE(png_image_write_to_file(&image, path.c_str(), 0, grey.data(), 0, nullptr), 0);
}

constexpr const char* pictured_obj =
    "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "usemtl m\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n";

TEST(Brightness, OfAnObjComesFromItsPicture) {
  const TemporaryFolder folder;
  write_png(folder.file("p.png"), 2, 2, {0, 51, 102, 255});
  folder.write("a.mtl", "newmtl m\nKd 1 1 1\nmap_Kd p.png\n");
  const Mesh mesh = read_mesh(folder.write("a.obj", pictured_obj));
  ASSERT_TRUE(mesh.brightness);
  EXPECT_TRUE(mesh.unread_pictures.empty());
  // The first triangle is (0, 0), (1, 0), (1, 1); positions by weights of the second and third.
  EXPECT_NEAR(mesh.brightness->at(0, 0.7, 0.2), 1.0, 1e-6);          // (0.9, 0.2): lower right
  EXPECT_NEAR(mesh.brightness->at(0, 0.1, 0.8), 51 / 255.0, 1e-6);   // (0.9, 0.8): upper right
  EXPECT_NEAR(mesh.brightness->at(0, 0.2, 0.1), 102 / 255.0, 1e-6);  // (0.3, 0.1): lower left
  EXPECT_NEAR(mesh.brightness->at(1, 0.1, 0.8), 0, 1e-6);            // (0.1, 0.9): upper left
}

TEST(Brightness, MissingPicturesAreNamedAndDoNotStopTheMesh) {
  const TemporaryFolder folder;
  const auto path = folder.write("a.obj", pictured_obj);
  EXPECT_FALSE(read_mesh(path).brightness);  // without materials
  folder.write("a.mtl", "newmtl m\nmap_Kd none.png\n");
  const Mesh mesh = read_mesh(path);
  EXPECT_EQ(mesh.triangles.size(), 2u);
  EXPECT_FALSE(mesh.brightness);
  ASSERT_EQ(mesh.unread_pictures.size(), 1u);
  EXPECT_THAT(mesh.unread_pictures[0], HasSubstr("none.png"));
  folder.write("none.png", "no picture");
  EXPECT_EQ(read_mesh(path).unread_pictures.size(), 1u);
}

TEST(Brightness, OptionsOfAPictureAreSkipped) {
  const TemporaryFolder folder;
  write_png(folder.file("my p.png"), 1, 1, {51});
  folder.write(
      "a.mtl",
      "newmtl other\nmap_Kd x.png\nnewmtl m\nmap_Kd -o 0 0 -mm 0 1 -clamp on my p.png\r\n");
  const Mesh mesh = read_mesh(folder.write("a.obj", pictured_obj));
  ASSERT_TRUE(mesh.brightness);
  EXPECT_NEAR(mesh.brightness->at(0, 0.3, 0.3), 0.2, 1e-6);
}

TEST(Brightness, DamagedMaterialsNeverStopTheMesh) {
  const TemporaryFolder folder;
  std::mt19937_64 random(6);
  const std::string whole =
      "newmtl m\nKd 1 1 1\nNs 10\nillum 2\nmap_Kd -o 0 0 0 -s 1 1 1 p.png\nmap_Bump -bm 1 b.png\n";
  const auto path = folder.write("a.obj", pictured_obj);
  for (int i = 0; i < test::scaled(500); ++i) {
    std::string bytes = whole.substr(0, 1 + random() % whole.size());
    for (std::uint32_t k = test::below(random, 4); k > 0; --k) {
      bytes[random() % bytes.size()] = static_cast<char>(random());
    }
    folder.write("a.mtl", bytes);
    EXPECT_EQ(read_mesh(path).triangles.size(), 2u);
  }
}

TEST(Brightness, OfAPlyComesFromItsVerticesAndLosesFlatTriangles) {
  const TemporaryFolder folder;
  const Mesh mesh = read_mesh(folder.write(
      "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
      "element face 3\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 255 255 255\n1 0 0 0 0 0\n0 1 0 255 0 0\n1 1 0 0 0 255\n"
      "3 0 1 2\n3 0 0 1\n3 3 2 1\n"));
  ASSERT_TRUE(mesh.brightness);
  ASSERT_EQ(mesh.triangles.size(), 2u);
  ASSERT_EQ(mesh.brightness->corners.size(), 2u);
  EXPECT_NEAR(mesh.brightness->at(0, 0, 0), 1, 1e-3);
  EXPECT_NEAR(mesh.brightness->at(0, 0.5, 0), 0.5, 1e-3);
  EXPECT_NEAR(mesh.brightness->at(0, 0, 1), 0.299, 1e-3);
  EXPECT_NEAR(mesh.brightness->at(1, 0, 0), 0.114, 1e-3);
}

std::string u32(std::size_t value) {
  std::string bytes;
  for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<char>(value >> (8 * i) & 0xFF));
  return bytes;
}

/// One triangle with an embedded picture and colours.
std::string glb_of(
    const std::string& png, const std::function<void(nlohmann::json&)>& change = [](auto&) {}) {
  std::string buffer;
  const std::vector<float> numbers{0, 0, 0, 1, 0, 0, 0, 1, 0,   // positions
                                   0, 1, 1, 1, 0, 0,            // texture coordinates, v down
                                   1, 1, 1, 1, 1, 1, 1, 1, 1};  // colours
  for (const float number : numbers) buffer.append(reinterpret_cast<const char*>(&number), 4);
  buffer += png;
  while (buffer.size() % 4 != 0) buffer.push_back('\0');
  nlohmann::json document = nlohmann::json::parse(R"({
    "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"material": 0,
      "attributes": {"POSITION": 0, "TEXCOORD_0": 1, "COLOR_0": 2}}]}],
    "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
    "textures": [{"source": 0}], "images": [{"bufferView": 3, "mimeType": "image/png"}],
    "accessors": [
      {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
       "min": [0, 0, 0], "max": [1, 1, 0]},
      {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"},
      {"bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC3"}],
    "bufferViews": [
      {"buffer": 0, "byteOffset": 0, "byteLength": 36},
      {"buffer": 0, "byteOffset": 36, "byteLength": 24},
      {"buffer": 0, "byteOffset": 60, "byteLength": 36},
      {"buffer": 0, "byteOffset": 96, "byteLength": 0}]})");
  document["buffers"] = {{{"byteLength", buffer.size()}}};
  document["bufferViews"][3]["byteLength"] = png.size();
  change(document);
  std::string text = document.dump();
  while (text.size() % 4 != 0) text.push_back(' ');
  return "glTF" + u32(2) + u32(12 + 8 + text.size() + 8 + buffer.size()) + u32(text.size()) +
         "JSON" + text + u32(buffer.size()) + std::string("BIN\0", 4) + buffer;
}

TEST(Brightness, OfAGlbComesFromThePictureInside) {
  const TemporaryFolder folder;
  write_png(folder.file("p.png"), 2, 2, {0, 51, 102, 255});
  const std::string png = read_file(folder.file("p.png"));
  const Mesh mesh = read_mesh(folder.write("a.glb", glb_of(png)));
  ASSERT_EQ(mesh.triangles.size(), 1u);
  ASSERT_TRUE(mesh.brightness);
  EXPECT_NEAR(mesh.brightness->at(0, 0.8, 0.1), 1.0, 1e-3);          // near (1, 0): lower right
  EXPECT_NEAR(mesh.brightness->at(0, 0.1, 0.1), 102 / 255.0, 1e-3);  // near (0, 0): lower left
  EXPECT_NEAR(mesh.brightness->at(0, 0.1, 0.8), 0, 1e-3);            // near (0, 1): upper left
}

TEST(ReadMesh, DamagedGlbIsRefused) {
  const TemporaryFolder folder;
  const std::string whole = glb_of("no picture");
  EXPECT_EQ(read_mesh(folder.write("a.glb", whole)).unread_pictures.size(), 1u);
  for (std::size_t size = 0; size < whole.size(); size += 1 + whole.size() / 60) {
    const auto path = folder.write("b.glb", whole.substr(0, size));
    EXPECT_THAT(error_of([&] { read_mesh(path); }), HasSubstr("b.glb"));
  }
  using nlohmann::json;
  const auto refusal = [&](const std::function<void(json&)>& change) {
    const auto path = folder.write("c.glb", glb_of("", change));
    return error_of([&] { read_mesh(path); });
  };
  EXPECT_THAT(refusal([](json& d) { d["bufferViews"][0]["byteLength"] = 4'000'000'000u; }),
              HasSubstr("a view reaches beyond the buffer"));
  EXPECT_THAT(refusal([](json& d) { d["bufferViews"][1]["buffer"] = 1; }),
              HasSubstr("a view without a buffer"));
  EXPECT_THAT(refusal([](json& d) { d["buffers"][0]["byteLength"] = 1000; }),
              HasSubstr("fewer numbers"));
  EXPECT_THAT(
      refusal([](json& d) { d["buffers"][0]["uri"] = "data:application/octet-stream,AAAA"; }),
      HasSubstr("a text in the document"));
  EXPECT_THAT(refusal([](json& d) { d["buffers"][0]["uri"] = "x.bin"; }),
              HasSubstr("another file"));
  EXPECT_THAT(refusal([](json& d) { d["accessors"][1]["count"] = 4; }),
              HasSubstr("accessor 1 is beyond its view"));
  EXPECT_THAT(refusal([](json& d) { d["accessors"][0]["count"] = 1u << 31; }),
              HasSubstr("accessor 0 is beyond its view"));
  EXPECT_THAT(refusal([](json& d) { d["accessors"][2]["bufferView"] = 9; }),
              HasSubstr("no such view"));
  EXPECT_THAT(refusal([](json& d) { d["accessors"][2]["componentType"] = 1; }), HasSubstr("type"));
  EXPECT_THAT(refusal([](json& d) { d["accessors"][2]["sparse"] = json::object(); }),
              HasSubstr("values of a wrong kind"));
  // The library traverses nodes and lists recursively.
  const auto chained = [](json& d) {
    for (int i = 1; i < 2000; ++i) d["nodes"].push_back({{"children", {i + 1}}});
    d["nodes"].push_back({{"mesh", 0}});
    d["scenes"][0]["nodes"] = {1};
  };
  EXPECT_THAT(refusal(chained), HasSubstr("too deep"));
  EXPECT_THAT(refusal([](json& d) {
                d["nodes"][0]["children"] = {0, 0};
              }),
              HasSubstr("do not form trees"));
  EXPECT_THAT(refusal([](json& d) {
                json list = json::array();
                // Deeper than the reader allows; the writer of this text also recurses.
                for (int i = 0; i < 200; ++i) list = json::array({std::move(list)});
                d["extras"] = std::move(list);
              }),
              HasSubstr("cannot be read"));
  EXPECT_THAT(refusal([](json& d) { d["bufferViews"] = "none"; }), HasSubstr("not a list"));
  EXPECT_THAT(refusal([](json& d) { d["bufferViews"][0]["byteOffset"] = "zero"; }),
              HasSubstr("wrong kind"));
}

TEST(ReadMesh, DamagedBytesOfAGlbAtWorstFail) {
  const TemporaryFolder folder;
  std::string printable;
  for (char byte = 32; byte < 127; ++byte) printable += byte;
  test::expect_damaged_read_or_refused(
      test::scaled(300), glb_of("no picture"), printable, [&](const std::string& bytes) {
        EXPECT_FALSE(read_mesh(folder.write("a.glb", bytes)).triangles.empty());
      });
}

}  // namespace
}  // namespace lamplock
