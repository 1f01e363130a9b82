// What 3MF files describe: units, parts, types of objects, extensions, colours.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "host/file.hpp"
#include "host/model/mesh_faults.hpp"
#include "host/model/transform.hpp"
#include "tests/damaged.hpp"
#include "tests/model/threemf_files.hpp"
#include "tests/scale.hpp"

namespace lamplock::threemf {
namespace {

using ::testing::HasSubstr;

/// The sides of the box round the mesh.
geometry::Point size_of(const Mesh& mesh) {
  const auto box = model::bounds(mesh.vertices);
  return {box.high.x - box.low.x, box.high.y - box.low.y, box.high.z - box.low.z};
}

TEST_F(Threemf, LengthsAreMillimetres) {
  const std::pair<const char*, double> units[]{{"micron", 0.001},  {"millimeter", 1},
                                               {"centimeter", 10}, {"inch", 25.4},
                                               {"foot", 304.8},    {"meter", 1000}};
  const std::string moved = item(1) + item(1, "transform=\"1 0 0 0 1 0 0 0 1 0 0 10\"");
  for (const auto& [unit, mm] : units) {
    const Mesh read = read_mesh(
        write_model(model_text(object(1, box_text()), moved, fmt::format("unit=\"{}\"", unit))));
    EXPECT_NEAR(size_of(read).x, 2 * mm, 1e-9 * mm) << unit;
    EXPECT_NEAR(size_of(read).z, 12 * mm, 1e-9 * mm) << unit;
  }
  EXPECT_EQ(size_of(read_mesh(write_model(model_text(object(1, box_text()), item(1), "")))).x, 2);
  const auto file = write_model(model_text(object(1, box_text()), item(1), "unit=\"parsec\""));
  EXPECT_THAT(error_of([&] { read_mesh(file); }), HasSubstr("'parsec' is not a unit"));
}

TEST_F(Threemf, PicturesAndSettingsInThePackageAreIgnored) {
  const auto file = write_model(model_text(object(1, box_text()), item(1)),
                                {{"Metadata/thumbnail.png", "\x89PNG, damaged"},
                                 {"Metadata/model_settings.config", "<config/>"},
                                 {"3D/_rels/3dmodel.model.rels", "<Relationships/>"}});
  EXPECT_EQ(read_mesh(file).triangles.size(), 12u);
}

TEST_F(Threemf, PrefixesAreThoseOfTheFile) {
  const std::string text = fmt::format(
      "<c:model xmlns:c=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" "
      "unit=\"inch\" requiredextensions=\"q\" "
      "xmlns:q=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\" "
      "xmlns:m=\"urn:of-a-slicer\"><c:resources><m:object id=\"1\"/></c:resources><c:build>"
      "<c:item objectid=\"1\" q:path=\"/3D/Objects/My%20box.model\" m:path=\"x\"/>"
      "</c:build></c:model>");
  const std::string part = model_text(object(1, box_text()), "", "unit=\"inch\"");
  const auto file = write_model(text, {{"3D/objects/my box.model", part}});
  EXPECT_NEAR(size_of(read_mesh(file)).y, 50.8, 1e-9);
  EXPECT_THAT(error_of([&] { read_mesh(write_model("<model unit=\"inch\"/>")); }),
              HasSubstr("is not a model"));  // without the namespace
}

TEST_F(Threemf, ObjectsInOtherPartsArePlaced) {
  const std::string path = "3D/Objects/object_1.model";
  const std::string box = object(1, box_text());
  EXPECT_EQ(size_of(read_mesh(write_parts(path, model_text(box, "")))).x, 2);
  // A part has the unit of the first part unless it names another.
  EXPECT_EQ(size_of(read_mesh(write_parts(path, model_text(box, "", "unit=\"meter\"")))).x, 2000);
  const std::string in_component = fmt::format(
      "<components><component objectid=\"1\" p:path=\"/{}\" "
      "transform=\"2 0 0 0 2 0 0 0 2 0 0 0\"/></components>",
      path);
  const auto file = write_model(model_text(object(1, in_component), item(1), "unit=\"centimeter\""),
                                {{path, model_text(box, "", "")}});
  EXPECT_NEAR(size_of(read_mesh(file)).x, 40, 1e-9);
  // Two parts that contain each other.
  const std::string back =
      fmt::format("<components><component objectid=\"1\" p:path=\"/{}\"/></components>", path);
  EXPECT_THAT(error_of([&] { read_mesh(write_parts(path, model_text(object(1, back), ""))); }),
              HasSubstr("object 1 of part '3D/Objects/object_1.model' contains itself"));
}

TEST_F(Threemf, SupportsAreLeftOut) {
  const std::string wide = mesh_text(test::box(50, 50, 50));
  for (const char* type : {"support", "solidsupport", "other"}) {
    const Mesh read = read_mesh(
        write(object(1, box_text()) + object(2, wide, type) + object(3, holding({1, 2}), "surface"),
              item(3) + item(2)));
    EXPECT_EQ(size_of(read).x, 2) << type;
    ASSERT_EQ(read.reader_warnings.size(), 1u);
    EXPECT_THAT(read.reader_warnings[0], HasSubstr("2 objects of type support or other"));
    EXPECT_THAT(error(object(2, wide, type), item(2)),
                HasSubstr("1 object is of type support or other"));
  }
  const Mesh read = read_mesh(
      write(object(1, box_text()) + object(2, wide), item(1) + item(2, "printable=\"0\"")));
  EXPECT_EQ(size_of(read).x, 2);
  EXPECT_EQ(read.reader_warnings.size(), 1u);
  EXPECT_THAT(error(object(2, wide, "lamp"), item(2)), HasSubstr("has the type 'lamp'"));
}

TEST_F(Threemf, RequiredExtensionsThatAreNotReadAreRefused) {
  const auto required = [&](const std::string& uri, const std::string& inside = "") {
    return write_model(model_text(object(1, box_text() + inside), item(1),
                                  "requiredextensions=\"p x\" xmlns:x=\"" + uri + "\""));
  };
  EXPECT_THAT(error_of([&] { read_mesh(required("urn:unknown")); }), HasSubstr("'urn:unknown'"));
  const std::string beams = "http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02";
  EXPECT_THAT(error_of([&] { read_mesh(required(beams)); }), HasSubstr("beam lattice"));
  const std::string lattice = "<b:beamlattice xmlns:b=\"" + beams + "\"/></mesh>";
  EXPECT_THAT(box_error("</mesh>", lattice), HasSubstr("object 1 has a beam lattice"));
  const auto undeclared =
      write_model(model_text(object(1, box_text()), item(1), "requiredextensions=\"z\""));
  EXPECT_THAT(error_of([&] { read_mesh(undeclared); }), HasSubstr("extension 'z'"));
  // Elements of extensions that are not required are ignored.
  std::string text = box_text();
  text.insert(text.find("</triangles>"), "<x:triangle xmlns:x=\"urn:x\" v1=\"99\"/>");
  EXPECT_EQ(read_mesh(write(object(1, text), item(1))).triangles.size(), 12u);
}

TEST_F(Threemf, ColoursBecomeBrightness) {
  const std::string resources =
      "<basematerials id=\"8\"><base name=\"a\" displaycolor=\"#FF0000\"/>"
      "<base name=\"b\" displaycolor=\"#FFFFFFFF\"/></basematerials>"
      "<m:colorgroup id=\"5\"><m:color color=\"#000000\"/><m:color color=\"#FFFFFF\"/>"
      "<m:color color=\"#00FF00\"/></m:colorgroup>"
      "<m:compositematerials id=\"4\" matid=\"8\" matindices=\"0 1\">"
      "<m:composite values=\"1 3\"/></m:compositematerials>"
      "<m:multiproperties id=\"3\" pids=\"8 5\"/>";
  const std::string corners =
      "<mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"0\"/>"
      "<vertex x=\"0\" y=\"1\" z=\"0\"/></vertices><triangles>";
  const std::string numbers = "<triangle v1=\"0\" v2=\"1\" v3=\"2\" ";
  const Mesh read = read_mesh(write(
      resources + "<object id=\"1\" pid=\"8\" pindex=\"0\">" + corners + numbers + "/>" + numbers +
          "p1=\"1\"/>" + numbers + "pid=\"5\" p1=\"0\" p2=\"1\" p3=\"2\"/>" + numbers +
          "pid=\"4\" p1=\"0\"/>" + numbers + "pid=\"3\" p1=\"7\"/></triangles></mesh></object>",
      item(1)));
  ASSERT_TRUE(read.brightness);
  ASSERT_EQ(read.brightness->corners.size(), 5u);
  EXPECT_NEAR(read.brightness->at(0, 0.3, 0.3), 0.299, 1e-6);  // of the object
  EXPECT_NEAR(read.brightness->at(1, 0.3, 0.3), 1, 1e-6);      // another one of its group
  EXPECT_NEAR(read.brightness->at(2, 0, 0), 0, 1e-6);
  EXPECT_NEAR(read.brightness->at(2, 1, 0), 1, 1e-6);
  EXPECT_NEAR(read.brightness->at(2, 0, 1), 0.587, 1e-6);
  EXPECT_NEAR(read.brightness->at(3, 0.3, 0.3), (0.299 + 3) / 4, 1e-6);
  EXPECT_EQ(read.brightness->at(4, 0.3, 0.3), 1);
  EXPECT_EQ(read.reader_warnings.size(), 1u);
}

TEST_F(Threemf, PicturesOfAPackageBecomeBrightness) {
  // A BMP of two pixels of 24 bits: black, white.
  using namespace std::string_literals;
  const std::string picture =
      "BM\x3E\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\x02\0\0\0\x01\0\0\0\x01\0\x18\0"s +
      std::string(24, '\0') + "\0\0\0\xFF\xFF\xFF\0\0"s;
  const std::string text =
      "<m:texture2d id=\"9\" path=\"/3D/t.bmp\" contenttype=\"image/png\"/>"
      "<m:texture2dgroup id=\"6\" texid=\"9\"><m:tex2coord u=\"0\" v=\"0\"/>"
      "<m:tex2coord u=\"1\" v=\"0\"/><m:tex2coord u=\"0\" v=\"1\"/></m:texture2dgroup>"
      "<object id=\"1\"><mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/>"
      "<vertex x=\"1\" y=\"0\" z=\"0\"/><vertex x=\"0\" y=\"1\" z=\"0\"/></vertices><triangles>"
      "<triangle v1=\"0\" v2=\"1\" v3=\"2\" pid=\"6\" p1=\"0\" p2=\"1\" p3=\"2\"/>"
      "</triangles></mesh></object>";
  const Mesh read = read_mesh(write_model(model_text(text, item(1)), {{"3D/t.bmp", picture}}));
  ASSERT_TRUE(read.brightness);
  EXPECT_TRUE(read.unread_pictures.empty());
  EXPECT_EQ(read.brightness->at(0, 0.2, 0.1), 0);
  EXPECT_EQ(read.brightness->at(0, 0.8, 0.1), 1);
  EXPECT_EQ(read_mesh(write(text, item(1))).unread_pictures.size(), 1u);
}

TEST_F(Threemf, MirroredObjectsStayOutsideOut) {
  const Mesh read = read_mesh(write(object(1, box_text()) + object(2, holding({1})),
                                    item(2, "transform=\"-1 0 0 0 1 0 0 0 1 0 0 0\"")));
  EXPECT_TRUE(test::is_closed(read));
  EXPECT_FALSE(model::find_faults(read).inside_out);
}

TEST_F(Threemf, Utf16IsRead) {
  std::string wide = "\xFF\xFE";
  std::string text = model_text(object(1, box_text()), item(1));
  for (const char c : text.substr(text.find("<model"))) wide += {c, '\0'};
  EXPECT_EQ(read_mesh(write_model(wide)).triangles.size(), 12u);
}

// Random objects in objects, compared with the product of their transformations.
TEST_F(Threemf, RandomNestingIsPlacedAsItsProduct) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> entry(-2, 2);
  for (int round = 0; round < test::scaled(40, 4); ++round) {
    const double r = 0.5;
    std::string resources = object(1, mesh_text(test::box(r, r, r)));
    std::vector<std::vector<geometry::Affine>> places{{}, {geometry::Affine{}}};
    const int count = 2 + static_cast<int>(test::below(random, 4));
    for (int id = 2; id <= count; ++id) {
      places.emplace_back();
      std::string inside = "<components>";
      for (auto n = test::below(random, 3) + 1; n > 0; --n) {
        const auto of = test::below(random, static_cast<std::uint32_t>(id - 1)) + 1;
        geometry::Affine map;
        for (auto* v : {&map.x, &map.y, &map.z, &map.offset})
          *v = {entry(random), entry(random), entry(random)};
        inside += fmt::format("<component objectid=\"{}\" transform=\"", of);
        for (const auto& v : {map.x, map.y, map.z, map.offset})
          inside += fmt::format("{} {} {} ", v.x, v.y, v.z);
        inside += "\"/>";
        for (const geometry::Affine& inner : places[of]) places.back().push_back(map * inner);
      }
      resources += object(id, inside + "</components>");
    }
    const Mesh read = read_mesh(write(resources, item(count)));
    ASSERT_EQ(read.triangles.size(), 12 * places.back().size());
    for (std::size_t i = 0; i < places.back().size(); ++i) {
      // The middle of a box is the mean of the corners that its twelve triangles use.
      geometry::Bounds box{{9e9, 9e9, 9e9}, {-9e9, -9e9, -9e9}};
      for (std::size_t t = 12 * i; t < 12 * (i + 1); ++t)
        for (const auto v : read.triangles[t]) {
          const auto& p = read.vertices[v];
          box = {{std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)},
                 {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)}};
        }
      EXPECT_LT(test::distance(box.centre(), places.back()[i].offset), 1e-9);
      const double half = (box.high.x - box.low.x) / 2;
      const auto& map = places.back()[i];
      EXPECT_NEAR(half, r * (std::abs(map.x.x) + std::abs(map.y.x) + std::abs(map.z.x)), 1e-9);
    }
  }
}

}  // namespace
}  // namespace lamplock::threemf
