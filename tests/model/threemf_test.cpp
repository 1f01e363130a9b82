// Containers, nesting and damage of 3MF files.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "host/bytes.hpp"
#include "host/file.hpp"
#include "host/model/mesh_faults.hpp"
#include "host/model/transform.hpp"
#include "tests/damaged.hpp"
#include "tests/model/threemf_files.hpp"
#include "tests/scale.hpp"

namespace lamplock::threemf {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST_F(Threemf, GivesTheWrittenBody) {
  const Mesh read =
      read_mesh(write(object(7, mesh_text(test::torus(10, 3, 24, 12, 0.1))), item(7)));
  EXPECT_EQ(read.vertices.size(), 24u * 12u);
  EXPECT_EQ(read.triangles.size(), 2u * 24u * 12u);
  EXPECT_TRUE(test::is_closed(read));
}

TEST_F(Threemf, ObjectsInObjectsAreCopiedAndMoved) {
  // Two boxes 5 apart in x, at twice the size; built here and again 100 further in y.
  const std::string pair =
      "<components><component objectid=\"1\" transform=\"2 0 0 0 2 0 0 0 2 0 0 0\"/>"
      "<component objectid=\"1\" transform=\"2 0 0 0 2 0 0 0 2 5 0 0\"/></components>";
  const Mesh read =
      read_mesh(write(object(1, box_text()) + object(2, pair) + object(3, holding({2})),
                      item(3) + item(3, "transform=\"1 0 0 0 1 0 0 0 1 0 100 0\"")));
  const auto one = test::box(1, 1, 1);
  EXPECT_EQ(read.triangles.size(), 4 * one.triangles.size());
  EXPECT_TRUE(test::is_closed(read));
  const auto was = model::bounds(one.vertices), is = model::bounds(read.vertices);
  EXPECT_NEAR(is.low.x, 2 * was.low.x, 1e-5);
  EXPECT_NEAR(is.high.x, 2 * was.high.x + 5, 1e-5);
  EXPECT_NEAR(is.high.y, 2 * was.high.y + 100, 1e-4);
  EXPECT_NEAR(is.high.z, 2 * was.high.z, 1e-5);
}

TEST_F(Threemf, UndefinedColoursAreRefused) {
  std::string text = box_text();
  const std::string triangle = "<triangle ";
  for (std::size_t at = text.find(triangle); at != std::string::npos;
       at = text.find(triangle, at + 1))
    text.insert(at + triangle.size(), "pid=\"5\" p1=\"0\" p2=\"1\" p3=\"1\" ");
  const std::string colours =
      "<m:colorgroup id=\"5\"><m:color color=\"#FFFFFF\"/><m:color color=\"#000000FF\"/>"
      "</m:colorgroup>";
  EXPECT_EQ(read_mesh(write(colours + object(1, text), item(1))).triangles.size(), 12u);
  std::string one_bad = colours;
  one_bad.replace(one_bad.find("#000000FF"), 9, "#0000000");
  EXPECT_THAT(error(one_bad + object(1, text), item(1)), HasSubstr("has the colour '#0000000'"));
  const std::string one = "<m:colorgroup id=\"5\"><m:color color=\"#FFFFFF\"/></m:colorgroup>";
  EXPECT_THAT(error(one + object(1, text), item(1)), HasSubstr("chooses colour 1 of 1"));
  EXPECT_THAT(error(object(1, text), item(1)), HasSubstr("properties 5, which do not exist"));
}

TEST_F(Threemf, ObjectsInThemselvesAreRefused) {
  EXPECT_THAT(error(object(4, holding({4})), item(4)), HasSubstr("object 4 contains itself"));
  EXPECT_THAT(error(object(1, box_text()) + object(2, holding({1, 3})) + object(3, holding({1, 2})),
                    item(2)),
              HasSubstr("contains itself"));
}

TEST_F(Threemf, DepthAndCopiesAreBounded) {
  constexpr int chain = 40'000;
  std::string deep = object(0, box_text());
  for (int i = 1; i <= chain; ++i) deep += object(i, holding({i - 1}));
  EXPECT_THAT(error(deep, item(chain)), HasSubstr("deeper than"));
  EXPECT_THAT(error(deep, item(0) + item(100) + item(101)), HasSubstr("deeper than"));
  EXPECT_EQ(read_mesh(write(deep, item(100))).triangles.size(), 12u);
  // Each object contains the preceding one twice: 2^40 copies.
  std::string doubling = object(0, box_text());
  for (int i = 1; i <= 40; ++i) doubling += object(i, holding({i - 1, i - 1}));
  EXPECT_THAT(error(doubling, item(40)), HasSubstr("placed objects"));
  EXPECT_EQ(read_mesh(write(doubling, item(3))).triangles.size(), 8 * 12u);
  std::vector<int> many(1000, 2);
  const std::string fine = mesh_text(test::torus(10, 3, 200, 100));  // 40 000 triangles
  EXPECT_THAT(error(object(2, fine) + object(3, holding(many)), item(3)),
              HasSubstr("placed triangles"));
}

/// An archive of stored parts whose sizes are in fields of ZIP64, as lib3mf writes them for parts
/// of any size ("APPNOTE.TXT - .ZIP File Format Specification", 4.3 and 4.5.3).
std::string zip64_archive(const std::vector<std::pair<std::string, std::string>>& parts) {
  constexpr std::uint32_t in_extra = 0xFFFFFFFF, local_mark = 0x04034B50, entry_mark = 0x02014B50,
                          end_mark = 0x06054B50;
  constexpr std::uint16_t version = 45, extra_id = 1, two_sizes = 16;
  const auto put = [](std::string& out, auto... values) { (append(out, values), ...); };
  constexpr std::uint16_t none = 0;
  std::string archive, directory;
  for (const auto& [name, bytes] : parts) {
    const auto crc =
        static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const unsigned char*>(bytes.data()),
                                         static_cast<unsigned>(bytes.size())));
    const auto offset = static_cast<std::uint32_t>(archive.size());
    const auto letters = static_cast<std::uint16_t>(name.size());
    const auto size = static_cast<std::uint64_t>(bytes.size());
    constexpr std::uint16_t extra_bytes = two_sizes + 4;
    std::string extra;
    put(extra, extra_id, two_sizes, size, size);
    put(archive, local_mark, version, none, none, none, none, crc, in_extra, in_extra, letters,
        extra_bytes);
    archive += name + extra + bytes;
    put(directory, entry_mark, version, version, none, none, none, none, crc, in_extra, in_extra,
        letters, extra_bytes, none, none, none, std::uint32_t{0}, offset);
    directory += name + extra;
  }
  const auto count = static_cast<std::uint16_t>(parts.size());
  std::string end;
  put(end, end_mark, none, none, count, count, static_cast<std::uint32_t>(directory.size()),
      static_cast<std::uint32_t>(archive.size()), none);
  return archive + directory + end;
}

TEST_F(Threemf, SizesOfZip64AreRead) {
  const std::string model = model_text(object(1, box_text()), item(1), "unit=\"inch\"");
  const auto file = folder_.write(
      "a.3mf", zip64_archive({{model_name, model}, {"_rels/.rels", relations(model_name)}}));
  const auto box = model::bounds(read_mesh(file).vertices);
  EXPECT_NEAR(box.high.x - box.low.x, 2 * 25.4, 1e-9);
}

TEST_F(Threemf, BombsAreRefusedBeforeUnpacking) {
  EXPECT_THAT(error_of([&] { read_mesh(write_model(std::string(8u << 20, '\0'))); }),
              AllOf(HasSubstr("3D/3dmodel.model"), HasSubstr("times its size")));
  const auto file = folder_.write("b.3mf", "");
  {
    const Archive archive(file);
    archive.add("_rels/.rels", relations(model_name));
    archive.add_claim(model_name, std::string(4u << 20, 'x'), 257u << 20);
  }
  EXPECT_THAT(error_of([&] { read_mesh(file); }), HasSubstr("unpacks to 257 MB"));
  const auto parts = folder_.write("c.3mf", "");
  {
    const Archive archive(parts);
    for (const char* name : {"a", "b", "c"})
      archive.add_claim(name, std::string(1u << 20, 'x'), 100u << 20);
  }
  EXPECT_THAT(error_of([&] { read_mesh(parts); }), HasSubstr("unpacks to 300 MB"));
}

TEST_F(Threemf, InvalidContainersAreRefused) {
  const std::string whole = read_file(write(object(1, box_text()), item(1)));
  for (const std::size_t length : {std::size_t{1}, whole.size() / 2, whole.size() - 22}) {
    const auto file = folder_.write("b.3mf", whole.substr(0, length));
    EXPECT_THAT(error_of([&] { read_mesh(file); }), HasSubstr("cut off"));
  }
  const auto of_parts = [&](const std::vector<std::pair<std::string, std::string>>& parts) {
    const auto file = folder_.write("c.3mf", "");
    {
      const Archive archive(file);
      for (const auto& [name, bytes] : parts) archive.add(name, bytes);
    }
    return error_of([&] { read_mesh(file); });
  };
  const std::string model = model_text(object(1, box_text()), item(1));
  EXPECT_THAT(of_parts({{model_name, model}}), HasSubstr("no part '_rels/.rels'"));
  EXPECT_THAT(of_parts({{"_rels/.rels", "<Relationships/>"}, {model_name, model}}),
              HasSubstr("names no part"));
  EXPECT_THAT(of_parts({{"_rels/.rels", relations("/3D/other.model")}, {model_name, model}}),
              HasSubstr("no part '3D/other.model'"));
  const std::pair<std::string, std::string> root{"_rels/.rels", relations(model_name)};
  EXPECT_THAT(of_parts({root, {model_name, model}, {model_name, model}}), HasSubstr("two parts"));
  EXPECT_THAT(of_parts({root, {"3D\\3dmodel.model", model}, {model_name, model}}),
              HasSubstr("a part has the unsafe name"));
  EXPECT_THAT(of_parts({root, {model_name, model}, {std::string(300, 'n'), "x"}}),
              HasSubstr("300 letters"));
  EXPECT_THAT(of_parts({root, {model_name, "<model>"}}), HasSubstr("not valid XML"));
  EXPECT_THAT(of_parts({root, {model_name, "<thing/>"}}), HasSubstr("is not a model"));
  EXPECT_THAT(of_parts({root, {model_name, std::string("<model/>\0", 9)}}), HasSubstr("UTF-8"));
}

TEST_F(Threemf, ModelsWithUndefinedReferencesAreRefused) {
  const std::string box = object(1, box_text());
  EXPECT_THAT(error(box, ""), HasSubstr("nothing is built"));
  EXPECT_THAT(error(box, item(2)), HasSubstr("object 2 is placed"));
  EXPECT_THAT(error(box + object(2, holding({9})), item(2)), HasSubstr("object 9 is placed"));
  EXPECT_THAT(error(box + box, item(1)), HasSubstr("has the id 1 twice"));
  EXPECT_THAT(error(box + "<object/>", item(1)), HasSubstr("an object has no id"));
  EXPECT_THAT(error(box, item(1, "p:path=\"/3D/b.model\"")), HasSubstr("no part '3D/b.model'"));
  EXPECT_THAT(error(box, item(1, "transform=\"1 0 0 0 1 0 0 0 0 0 0 0\"")), HasSubstr("a plane"));
  EXPECT_THAT(error(box, item(1, "transform=\"1 2 3\"")), HasSubstr("item 0 of the build"));
  EXPECT_THAT(error(box, item(1, "transform=\"1 0 0 0 1 0 0 0 1 0 0 nan\"")), HasSubstr("'nan'"));
  EXPECT_THAT(error(object(1, "<mesh/>"), item(1)),
              HasSubstr("object 1 must have exactly one <vertices>"));
  EXPECT_THAT(box_error("v1=\"", "v1=\"99"), HasSubstr("triangle 0 of object 1 names vertex"));
  EXPECT_THAT(box_error("v2=\"", "v2=\"-"), HasSubstr("triangle 0 of object 1 has v2"));
  EXPECT_THAT(box_error("x=\"", "x=\"1e999"), HasSubstr("vertex 0 of object 1 has x"));
  EXPECT_THAT(box_error("</vertices>", "</vertices><vertices/>"),
              HasSubstr("exactly one <vertices>"));
  EXPECT_THAT(box_error("<vertices>", "<triangles/><vertices>"),
              HasSubstr("exactly one <triangles>"));
  EXPECT_THAT(box_error("x=\"", "w=\""), HasSubstr("vertex 0 of object 1 has x ''"));
  EXPECT_THAT(error(object(1, ""), item(1)), HasSubstr("has neither a mesh nor components"));
}

// The contents of the archive are damaged, not the archive: its checksums are right.
TEST_F(Threemf, DamagedModelsAtWorstFail) {
  const std::string whole = model_text(
      "<basematerials id=\"8\"><base name=\"a\" displaycolor=\"#102030\"/></basematerials>"
      "<m:colorgroup id=\"5\"><m:color color=\"#FFFFFF\"/></m:colorgroup>"
      "<m:texture2d id=\"9\" path=\"/t.png\"/>"
      "<m:texture2dgroup id=\"6\" texid=\"9\"><m:tex2coord u=\"0\" v=\"1\"/></m:texture2dgroup>"
      "<m:compositematerials id=\"7\" matid=\"8\" matindices=\"0\"><m:composite values=\"1\"/>"
      "</m:compositematerials><object id=\"1\" pid=\"8\" pindex=\"0\"><mesh><vertices><vertex "
      "x=\"0\" y=\"0\" z=\"0\"/>"
      "<vertex x=\"1\" y=\"0\" z=\"0\"/><vertex x=\"0\" y=\"1\" z=\"2\"/></vertices><triangles>"
      "<triangle v1=\"0\" v2=\"1\" v3=\"2\" pid=\"5\" p1=\"0\" p2=\"0\" p3=\"0\"/>"
      "<triangle v1=\"0\" v2=\"2\" v3=\"1\" pid=\"6\" p1=\"0\"/></triangles></mesh></object>"
      "<object id=\"2\"><components><component objectid=\"1\" p:path=\"/3D/3dmodel.model\" "
      "transform=\"1 0 0 0 1 0 0 0 1 0 0 1\"/></components></object>",
      item(2) + item(1));
  ASSERT_EQ(read_mesh(write_model(whole)).triangles.size(), 4u);
  test::expect_damaged_read_or_refused(
      test::scaled(600), whole, "0123456789.- <>/\"=cmovptx:#", [&](const std::string& bytes) {
        EXPECT_FALSE(read_mesh(write_model(bytes)).triangles.empty());
      });
}

/// The archive with a field of two bytes replaced in every local header (at `local`) and every
/// entry of the directory (at `central`) of its last part.
std::string with_field(std::string bytes, std::size_t local, std::size_t central, int value) {
  const auto put = [&](std::size_t at) {
    bytes[at] = static_cast<char>(value & 0xff);
    bytes[at + 1] = static_cast<char>(value >> 8);
  };
  put(bytes.rfind("PK\3\4") + local);
  put(bytes.rfind("PK\1\2") + central);
  return bytes;
}

TEST_F(Threemf, OtherCompressionsAndEncryptionAreNamed) {
  const std::string whole = read_file(write(object(1, box_text()), item(1)));
  const auto error_after = [&](std::size_t local, std::size_t central, int value) {
    const auto file = folder_.write("b.3mf", with_field(whole, local, central, value));
    return error_of([&] { read_mesh(file); });
  };
  constexpr std::size_t method = 8, central_method = 10, flags = 6, central_flags = 8;
  for (const auto& [number, name] : std::vector<std::pair<int, std::string>>{{9, "Deflate64"},
                                                                             {12, "BZIP2"},
                                                                             {14, "LZMA"},
                                                                             {93, "Zstandard"},
                                                                             {95, "XZ"},
                                                                             {98, "PPMd"},
                                                                             {77, "method 77"}})
    EXPECT_THAT(error_after(method, central_method, number),
                AllOf(HasSubstr("'3D/3dmodel.model' is compressed with " + name),
                      HasSubstr("with Deflate")));
  EXPECT_THAT(error_after(flags, central_flags, 1),
              AllOf(HasSubstr("'3D/3dmodel.model' is encrypted"), HasSubstr("password")));
}

TEST_F(Threemf, DamagedArchivesAtWorstFail) {
  const std::string whole = read_file(write(object(1, box_text()), item(1)));
  test::expect_damaged_read_or_refused(
      test::scaled(600), whole, test::any_byte(), [&](const std::string& bytes) {
        EXPECT_FALSE(read_mesh(folder_.write("b.3mf", bytes)).triangles.empty());
      });
}

}  // namespace
}  // namespace lamplock::threemf
