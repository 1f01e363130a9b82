#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <minizip/zip.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "host/file.hpp"
#include "host/model/mesh_faults.hpp"
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
using ::testing::AllOf;
using ::testing::HasSubstr;

/// Writes ZIP archives part by part.
class Archive {
 public:
  explicit Archive(const std::filesystem::path& file)
      : zip_(zipOpen64(file.c_str(), APPEND_STATUS_CREATE)) {}
  ~Archive() { zipClose(zip_, nullptr); }
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;

  void add(const std::string& name, const std::string& bytes) const {
    zip_fileinfo info{};
    zipOpenNewFileInZip64(zip_, name.c_str(), &info, nullptr, 0, nullptr, 0, nullptr, Z_DEFLATED,
                          Z_BEST_SPEED, 0);
    zipWriteInFileInZip(zip_, bytes.data(), static_cast<unsigned>(bytes.size()));
    zipCloseFileInZip(zip_);
  }

  /// Adds a part whose header claims an unpacked size of `bytes`.
  void add_claim(const std::string& name, const std::string& packed, std::uint64_t bytes) const {
    zip_fileinfo info{};
    constexpr int raw = 1;
    zipOpenNewFileInZip2_64(zip_, name.c_str(), &info, nullptr, 0, nullptr, 0, nullptr, Z_DEFLATED,
                            Z_BEST_SPEED, raw, 0);
    zipWriteInFileInZip(zip_, packed.data(), static_cast<unsigned>(packed.size()));
    zipCloseFileInZipRaw64(zip_, bytes, 0);
  }

 private:
  zipFile zip_;
};

constexpr const char* model_name = "3D/3dmodel.model";

std::string relations(const std::string& target) {
  return "<?xml version=\"1.0\"?><Relationships xmlns=\"http://schemas.openxmlformats.org/package/"
         "2006/relationships\"><Relationship Id=\"rel0\" Target=\"" +
         target +
         "\" Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/>"
         "</Relationships>";
}

constexpr const char* namespaces =
    "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" "
    "xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\" "
    "xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\" ";

std::string model_text(const std::string& resources, const std::string& build,
                       const std::string& attributes = "unit=\"millimeter\"") {
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?><model {} {}><resources>{}</resources>"
      "<build>{}</build></model>",
      namespaces, attributes, resources, build);
}

std::string mesh_text(const Mesh& mesh) {
  std::string text = "<mesh><vertices>";
  for (const auto& v : mesh.vertices)
    text += fmt::format("<vertex x=\"{:.9g}\" y=\"{:.9g}\" z=\"{:.9g}\"/>", v.x, v.y, v.z);
  text += "</vertices><triangles>";
  for (const auto& t : mesh.triangles)
    text += fmt::format("<triangle v1=\"{}\" v2=\"{}\" v3=\"{}\"/>", t[0], t[1], t[2]);
  return text + "</triangles></mesh>";
}

std::string object(int id, const std::string& content, const std::string& type = "model") {
  return fmt::format("<object id=\"{}\" type=\"{}\">{}</object>", id, type, content);
}

/// Components that refer to these objects.
std::string holding(const std::vector<int>& ids) {
  std::string text = "<components>";
  for (const int id : ids) text += fmt::format("<component objectid=\"{}\"/>", id);
  return text + "</components>";
}

std::string item(int id, const std::string& more = "") {
  return fmt::format("<item objectid=\"{}\" {}/>", id, more);
}

/// A box of 1 x 1 x 1 mm round the origin.
std::string box_text() { return mesh_text(test::box(1, 1, 1)); }

class Threemf : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& resources, const std::string& build) const {
    return write_model(model_text(resources, build));
  }
  std::filesystem::path write_model(
      const std::string& text,
      const std::vector<std::pair<std::string, std::string>>& more = {}) const {
    auto file = folder_.write("a.3mf", "");
    const Archive archive(file);
    archive.add("[Content_Types].xml", "<Types/>");
    archive.add("_rels/.rels", relations("/3D/3dmodel.model"));
    archive.add(model_name, text);
    for (const auto& [name, bytes] : more) archive.add(name, bytes);
    return file;
  }
  /// A box in another part, placed by the first.
  std::filesystem::path write_parts(const std::string& part, const std::string& other) const {
    return write_model(model_text("", item(1, "p:path=\"/" + part + "\"")), {{part, other}});
  }
  std::string error(const std::string& resources, const std::string& build) const {
    return error_of([&] { read_mesh(write(resources, build)); });
  }
  /// Error of a model of a box in which `what` is replaced.
  std::string box_error(const std::string& what, const std::string& instead) const {
    std::string text = box_text();
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return error(object(1, text.replace(at, what.size(), instead)), item(1));
  }

  const TemporaryFolder folder_;
};

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
    EXPECT_THAT(error(object(2, wide, type), item(2)), HasSubstr("no triangle"));
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

TEST_F(Threemf, DamagedArchivesAtWorstFail) {
  const std::string whole = read_file(write(object(1, box_text()), item(1)));
  test::expect_damaged_read_or_refused(
      test::scaled(600), whole, test::any_byte(), [&](const std::string& bytes) {
        EXPECT_FALSE(read_mesh(folder_.write("b.3mf", bytes)).triangles.empty());
      });
}

}  // namespace
}  // namespace lamplock
