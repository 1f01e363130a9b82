// HATCH, SOLID, TRACE and 3DFACE; binary files; units; hidden layers of inserted blocks.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <sstream>
#include <string>

#include "host/geometry/bounds.hpp"
#include "host/model/arc_length.hpp"
#include "host/model/read_dxf.hpp"
#include "tests/error_of.hpp"
#include "tests/model/damaged_drawing.hpp"
#include "tests/model/dxf_text.hpp"
#include "tests/scale.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::dxf_areas_test {
namespace {

using geometry::Point;
using model::ArcLength;
using model::Curves;
using model::Path;
using model::read_dxf;
using std::numbers::pi;
using test::binary_dxf;
using test::dxf_drawing;
using test::dxf_section;
using test::error_of;
using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;

class DxfAreas : public ::testing::Test {
 protected:
  Curves read(const std::string& bytes) { return read_dxf(folder_.write("a.dxf", bytes)); }
  Curves entities(const std::string& groups) { return read(dxf_drawing(groups)); }
  std::string error(const std::string& bytes) {
    const auto path = folder_.write("a.dxf", bytes);
    return error_of([&] { read_dxf(path); });
  }

  const test::TemporaryFolder folder_;
};

double length(const Path& path) { return ArcLength(path).total(); }

/// A HATCH with these boundary paths.
std::string hatch(int paths, const std::string& boundaries, const std::string& before = "") {
  return "0 HATCH 8 0 10 0 20 0 30 0 " + before + " 2 SOLID 70 1 71 0 91 " + std::to_string(paths) +
         " " + boundaries + " 75 0 76 1 98 1 10 1 20 1";
}

const std::string slot_boundary =
    "92 3 72 1 73 1 93 4 10 0 20 0 42 0 10 10 20 0 42 1 10 10 20 4 42 0 10 0 20 4 42 1 97 0";

TEST_F(DxfAreas, HatchesAreOutlined) {
  const Curves slot = entities(hatch(1, slot_boundary));
  ASSERT_EQ(slot.paths.size(), 1u);
  EXPECT_TRUE(slot.paths[0].closed);
  EXPECT_NEAR(length(slot.paths[0]), 20 + 4 * pi, 1e-9);
  EXPECT_THAT(slot.left_out, IsEmpty());
  // A half disc of a line and an arc, and a circle in it.
  const std::string arc = "72 2 10 0 20 0 40 5 50 0 51 180 73 1";
  const Curves two = entities(hatch(2, "92 1 93 2 " + arc +
                                           " 72 1 10 -5 20 0 11 5 21 0 97 0 92 16 "
                                           "93 1 72 2 10 0 20 2 40 1 50 0 51 360 73 1 97 0"));
  ASSERT_EQ(two.paths.size(), 2u);
  EXPECT_TRUE(two.paths[0].closed);
  EXPECT_NEAR(length(two.paths[0]), 10 + 5 * pi, 1e-9);
  EXPECT_NEAR(length(two.paths[1]), 2 * pi, 1e-9);
  EXPECT_NEAR(model::bounds(two).high.y, 5, 1e-6);
}

// Clockwise arcs count their angles clockwise; edges in the wrong direction are turned.
TEST_F(DxfAreas, EdgesOfAHatchAreJoined) {
  const std::string clockwise = "72 2 10 0 20 0 40 5 50 180 51 360 73 0";  // (-5,0) (0,5) (5,0)
  for (const std::string line : {"72 1 10 5 20 0 11 -5 21 0", "72 1 10 -5 20 0 11 5 21 0"}) {
    for (const std::string& edges : {clockwise + " " + line, line + " " + clockwise}) {
      const Curves curves = entities(hatch(1, "92 1 93 2 " + edges + " 97 0"));
      ASSERT_EQ(curves.paths.size(), 1u) << edges;
      EXPECT_TRUE(curves.paths[0].closed);
      EXPECT_NEAR(length(curves.paths[0]), 10 + 5 * pi, 1e-9);
      EXPECT_NEAR(model::bounds(curves).high.y, 5, 1e-6) << edges;
      EXPECT_NEAR(model::bounds(curves).low.y, 0, 1e-6) << edges;
    }
  }
}

// The neighbours decide whether angles of an ellipse are parameters or rays.
TEST_F(DxfAreas, EllipsesAndSplinesOfAHatch) {
  // A quarter to the parameter of 45 degrees, and to the ray of 45 degrees.
  const double root = std::sqrt(0.5);
  const double ray = 10 * 5 / std::hypot(10 * root, 5 * root) * root;
  for (const Point end : {Point{10 * root, 5 * root, 0}, Point{ray, ray, 0}}) {
    const Curves curves =
        entities(hatch(1, fmt::format("92 1 93 3 72 3 10 0 20 0 11 10 21 0 40 0.5 50 0 51 45 73 1 "
                                      "72 1 10 {0} 20 {1} 11 0 21 0 72 1 10 0 20 0 11 10 21 0 97 0",
                                      end.x, end.y)));
    ASSERT_EQ(curves.paths.size(), 1u);
    EXPECT_TRUE(curves.paths[0].closed);
    EXPECT_EQ(curves.paths[0].pieces.size(), 3u);
  }
  const std::string spline =
      "72 4 94 2 73 0 74 0 95 6 96 3 40 0 40 0 40 0 40 1 40 1 40 1 10 0 20 0 10 0.5 20 0 10 1 20 1";
  const double parabola = std::sqrt(5.0) / 2 + std::asinh(2.0) / 4;
  for (const std::string fit : {"", "97 0", "97 2 11 0 21 0 11 1 21 1 12 1 22 0 13 1 23 2"}) {
    const Curves curves = entities(
        hatch(1, "92 1 93 2 " + spline + " " + fit + " 72 1 10 1 20 1 11 0 21 0 97 1 330 AB"));
    ASSERT_EQ(curves.paths.size(), 1u) << fit;
    EXPECT_NEAR(length(curves.paths[0]), parabola + std::sqrt(2.0), 1e-9) << fit;
  }
}

TEST_F(DxfAreas, HatchesAreDrawnOnceWithTheirSource) {
  const std::string circle = "0 CIRCLE 5 A1 8 edge 10 0 20 0 40 5 ";
  const std::string filled = hatch(1, "92 1 93 1 72 2 10 0 20 0 40 5 50 0 51 360 73 1 97 1 330 A1");
  EXPECT_EQ(entities(circle + filled).paths.size(), 1u);
  EXPECT_EQ(entities(filled + " " + circle).paths.size(), 1u);
  EXPECT_EQ(entities(filled).paths.size(), 1u);
  // The source is hidden, the hatch is not.
  const Curves curves = read(dxf_drawing(
      circle + filled, dxf_section("TABLES", "0 TABLE 2 LAYER 0 LAYER 2 EDGE 70 1 62 7 0 ENDTAB")));
  EXPECT_EQ(curves.paths.size(), 1u);
  EXPECT_EQ(curves.layers.at(0), "0");
}

TEST_F(DxfAreas, HatchesKeepElevationAndExtrusion) {
  const std::string line = "92 1 93 1 72 1 10 1 20 2 11 4 21 6 97 0";
  const Curves raised = entities("0 HATCH 10 0 20 0 30 7 210 0 220 0 230 -1 91 1 " + line);
  EXPECT_EQ(model::start_of(raised.paths.at(0)), (Point{-1, 2, -7}));
  EXPECT_EQ(model::end_of(raised.paths.at(0)), (Point{-4, 6, -7}));
}

TEST_F(DxfAreas, DamagedHatchesAreNamed) {
  EXPECT_THAT(error(dxf_drawing(hatch(1, "92 1 93 1 72 9 10 1 20 1"))), HasSubstr("type 9"));
  EXPECT_THAT(error(dxf_drawing(hatch(1, "92 1 93 1 72 1 10 1 20 1"))), HasSubstr("group 11"));
  EXPECT_THAT(error(dxf_drawing(hatch(1, "92 1 93 1 72 2 10 1 20 1 40 0"))), HasSubstr("radius"));
  EXPECT_THAT(error(dxf_drawing("0 HATCH 2 SOLID 91 0")), HasSubstr("left out: 1 HATCH"));
}

TEST_F(DxfAreas, FacesHaveTheirVisibleEdges) {
  const std::string face = "0 3DFACE 10 0 20 0 30 1 11 3 21 0 31 2 12 3 22 4 32 3 13 0 23 4 33 4";
  const Curves whole = entities(face);
  ASSERT_EQ(whole.paths.size(), 4u);
  EXPECT_EQ(model::start_of(whole.paths[2]), (Point{3, 4, 3}));
  EXPECT_EQ(model::end_of(whole.paths[2]), (Point{0, 4, 4}));
  EXPECT_EQ(entities(face + " 70 5").paths.size(), 2u);
  EXPECT_EQ(model::end_of(entities(face + " 70 5").paths.at(1)), (Point{0, 0, 1}));
  EXPECT_THAT(error(dxf_drawing(face + " 70 15")), HasSubstr("without visible edges"));
  const std::string triangle = "0 3DFACE 10 0 20 0 30 0 11 3 21 0 31 0 12 3 22 4 32 0 ";
  for (const std::string fourth : {"", "13 3 23 4 33 0"}) {
    EXPECT_EQ(entities(triangle + fourth).paths.size(), 3u);
    EXPECT_EQ(entities(triangle + fourth + " 70 8").paths.size(), 2u);
  }
}

TEST_F(DxfAreas, SolidsAndTracesAreOutlined) {
  const std::string corners = " 10 0 20 0 30 2 11 3 21 0 31 2 12 0 22 4 32 2 13 3 23 4 33 2";
  for (const std::string kind : {"SOLID", "TRACE"}) {
    const Curves curves = entities("0 " + kind + corners);
    ASSERT_EQ(curves.paths.size(), 1u);
    EXPECT_TRUE(curves.paths[0].closed);
    EXPECT_NEAR(length(curves.paths[0]), 14, 1e-12);  // not a bow tie
    EXPECT_EQ(model::bounds(curves).low.z, 2);
  }
  EXPECT_NEAR(
      length(
          entities("0 SOLID 10 0 20 0 11 3 21 0 12 3 22 4 13 3 23 4 230 -1 210 0 220 0").paths[0]),
      12, 1e-12);
}

TEST_F(DxfAreas, MissingUnitsWarn) {
  const std::string line = "0 LINE 10 0 20 0 11 1 21 0";
  const auto warnings = [&](const std::string& header) {
    return read(dxf_drawing(line, header.empty() ? "" : dxf_section("HEADER", header))).warnings;
  };
  EXPECT_THAT(warnings(""), ElementsAre(HasSubstr("no unit")));
  EXPECT_THAT(warnings("9 $INSUNITS 70 0"), ElementsAre(HasSubstr("no unit")));
  EXPECT_THAT(warnings("9 $MEASUREMENT 70 0"), ElementsAre(HasSubstr("inches")));
  EXPECT_THAT(warnings("9 $MEASUREMENT 70 0 9 $INSUNITS 70 1"), IsEmpty());
  EXPECT_THAT(warnings("9 $INSUNITS 70 4"), IsEmpty());
}

// A frozen layer hides all that is in its inserts, one that is off only what is on it.
TEST_F(DxfAreas, LayersThatAreOffKeepTheirInserts) {
  const auto paths = [&](const std::string& layer) {
    const std::string before =
        dxf_section("TABLES", "0 TABLE 2 LAYER 0 LAYER 2 L " + layer + " 0 ENDTAB") +
        dxf_section("BLOCKS",
                    "0 BLOCK 2 B 10 0 20 0 0 LINE 8 0 11 1 21 0 0 LINE 8 other 11 1 21 0 0 ENDBLK");
    return read(dxf_drawing("0 INSERT 8 L 2 B 0 LINE 8 x 11 1 21 0", before)).paths.size();
  };
  EXPECT_EQ(paths("70 0 62 7"), 3u);
  EXPECT_EQ(paths("70 0 62 -7"), 2u);
  EXPECT_EQ(paths("70 1 62 7"), 1u);
}

TEST_F(DxfAreas, LayersThatAreNotPlottedAreLeftOutByName) {
  const std::string line = " 11 1 21 0 ";
  const auto drawn = [&](const std::string& layer, const std::string& of_line) {
    return read(dxf_drawing(
        "0 LINE 8 x" + line + "0 LINE 8 " + of_line + line + "0 POINT 8 " + of_line + " 10 1 20 1",
        dxf_section("TABLES",
                    "0 TABLE 2 LAYER 0 LAYER " + layer + " 0 LAYER 2 x 70 0 290 1 0 ENDTAB")));
  };
  const Curves construction = drawn("2 Guide 70 0 62 7 290 0", "GUIDE");
  EXPECT_EQ(construction.paths.size(), 1u);
  EXPECT_THAT(construction.left_out,
              ElementsAre(Pair("on layer 'GUIDE', which is not plotted", 2u)));
  // Defpoints is never plotted, with or without an entry and whatever its flag.
  for (const std::string layer : {"2 y 70 0", "2 DEFPOINTS 70 0 290 1", "2 Defpoints 290 0"})
    EXPECT_THAT(drawn(layer, "Defpoints").left_out,
                ElementsAre(Pair("on layer 'Defpoints', which is not plotted", 2u)));
  EXPECT_THAT(drawn("2 L 70 0 290 1", "L").left_out, IsEmpty());
  EXPECT_THAT(drawn("2 L 70 1 290 0", "L").left_out, ElementsAre(Pair("hidden", 2u)));
  // In a block: the layer 0 is that of the insert, other layers are their own.
  const Curves block =
      read(dxf_drawing("0 INSERT 8 L 2 B 0 LINE 8 x" + line,
                       dxf_section("TABLES", "0 TABLE 2 LAYER 0 LAYER 2 L 290 0 0 ENDTAB") +
                           dxf_section("BLOCKS", "0 BLOCK 2 B 10 0 20 0 0 LINE 8 0" + line +
                                                     "0 LINE 8 other" + line + "0 ENDBLK")));
  EXPECT_EQ(block.paths.size(), 2u);
  EXPECT_THAT(block.left_out, ElementsAre(Pair("on layer 'L', which is not plotted", 1u)));
}

// Every end of the data within the boundaries is an error, never a part of the outline.
TEST_F(DxfAreas, HatchesThatAreCutOffAreRefused) {
  const std::string kinds[] = {
      slot_boundary,
      "92 1 93 2 72 2 10 0 20 0 40 5 50 0 51 180 73 1 72 1 10 -5 20 0 11 5 21 0 97 0",
  };
  for (const std::string& boundary : kinds) {
    const std::string text = "0 HATCH 8 0 10 0 20 0 30 0 2 SOLID 91 2 " + boundary + " " + boundary;
    std::istringstream words(text);
    std::string code, value, part;
    int groups = 0;
    while (words >> code >> value) {
      part += code + " " + value + " ";
      const bool has_boundaries = ++groups > 6;
      const bool is_whole = part.size() == text.size() + 1;
      const bool is_last_count = part.size() + 5 == text.size() + 1;  // 97 0
      if (!has_boundaries || is_whole || is_last_count) continue;
      const std::string drawing = dxf_drawing("0 LINE 11 1 21 0 " + part);
      EXPECT_THAT(error(drawing), AnyOf(HasSubstr("its data end after"), HasSubstr("is missing")))
          << part;
    }
    EXPECT_EQ(entities(text).paths.size(), 2u);
  }
}

TEST_F(DxfAreas, BlocksOfOtherFilesAreCounted) {
  const Curves curves = read(dxf_drawing(
      "0 INSERT 2 X 0 LINE 11 1 21 0", dxf_section("BLOCKS", "0 BLOCK 2 X 70 4 1 x.dwg 0 ENDBLK")));
  EXPECT_THAT(curves.left_out, ElementsAre(Pair("INSERT of another file", 1u)));
}

// Names and hidden items of a block cost time in each copy.
TEST_F(DxfAreas, CopiesOfNothingAreRefused) {
  std::string kinds, hidden;
  for (int i = 0; i < 300; ++i) kinds += fmt::format("0 THING{} ", i) + "8 0 ";
  for (int i = 0; i < 300; ++i) hidden += "0 LINE 8 L 11 1 21 0 ";
  for (const std::string& content : {kinds, hidden}) {
    const std::string before =
        dxf_section("TABLES", "0 TABLE 2 LAYER 0 LAYER 2 L 70 1 62 7 0 ENDTAB") +
        dxf_section("BLOCKS", "0 BLOCK 2 B 10 0 20 0 " + content + "0 ENDBLK");
    EXPECT_THAT(error(dxf_drawing("0 INSERT 2 B 70 10000 71 10000", before)), HasSubstr("pieces"));
  }
}

const std::string everything = dxf_drawing(
    "0 LINE 5 1F 8 a 10 1 20 2 30 .125 11 3 21 4 31 5e-3 0 ARC 10 0 20 0 40 2 50 10 51 80 "
    "0 LWPOLYLINE 90 3 70 1 10 0 20 0 42 .5 10 3 20 0 10 3 20 3 0 POINT 10 1 20 1 30 -1e6 "
    "0 INSERT 2 B 10 1 20 1 41 2 70 2 44 5 210 0 220 0 230 -1 0 TEXT 1 hello 290 1 310 ABCD "
    "0 3DFACE 10 0 20 0 30 1 11 3 21 0 31 2 12 3 22 4 32 3 13 0 23 4 33 4 70 2 " +
        hatch(2, slot_boundary + " 92 1 93 2 72 2 10 0 20 0 40 5 50 0 51 180 73 1 "
                                 "72 3 10 0 20 0 11 5 21 0 40 .5 50 180 51 360 73 0 97 0") +
        " 0 SOLID 10 0 20 0 11 3 21 0 12 0 22 4 13 3 23 4 1000 x 1040 1",
    dxf_section("HEADER", "9 $ACADVER 1 AC1015 9 $INSUNITS 70 1") +
        dxf_section("BLOCKS", "0 BLOCK 2 B 10 0 20 0 0 CIRCLE 8 0 10 0 20 0 40 1 0 ENDBLK"));

// A binary drawing is the text drawing, bit for bit.
TEST_F(DxfAreas, BinaryEqualsText) {
  const std::string text = everything;
  const Curves expected = read(text);
  ASSERT_GE(expected.paths.size(), 9u);
  for (const bool short_codes : {false, true}) {
    const Curves curves = read(binary_dxf(text, short_codes));
    ASSERT_EQ(curves.paths.size(), expected.paths.size());
    EXPECT_EQ(curves.points, expected.points);
    EXPECT_EQ(curves.layers, expected.layers);
    EXPECT_EQ(curves.left_out, expected.left_out);
    for (std::size_t i = 0; i < curves.paths.size(); ++i) {
      EXPECT_EQ(model::start_of(curves.paths[i]), model::start_of(expected.paths[i]));
      EXPECT_EQ(length(curves.paths[i]), length(expected.paths[i]));
    }
  }
}

TEST_F(DxfAreas, BinaryErrorsNameTheByteOrTheGroup) {
  const std::string whole = binary_dxf(dxf_drawing("0 CIRCLE 10 0 20 0 40 1"), false);
  EXPECT_THAT(error(whole.substr(0, whole.size() - 5)), HasSubstr("cut off"));
  EXPECT_THAT(error(whole.substr(0, 22)), HasSubstr("byte 22: the drawing is cut off"));
  EXPECT_THAT(error(binary_dxf(dxf_drawing("0 CIRCLE 10 0 20 0 40 0"), false)),
              HasSubstr("group 3: its radius is 0"));
  std::string unknown = whole;
  unknown.replace(22, 2, "\x50\x00", 2);
  EXPECT_THAT(error(unknown), HasSubstr("80 is not a group code"));
  EXPECT_THAT(error(binary_dxf(dxf_drawing("0 LINE 10 nan"), false)), HasSubstr("'nan'"));
}

TEST_F(DxfAreas, DamagedFilesAtWorstFail) {
  const std::string text = everything;
  const auto read_file = [](const auto& path) { return read_dxf(path); };
  test::expect_damaged_drawings_fail_at_most(folder_, "a.dxf", text, "0123456789.-+eE \n\xFFnx",
                                             read_file);
  for (const bool short_codes : {false, true})
    test::expect_damaged_drawings_fail_at_most(folder_, "a.dxf", binary_dxf(text, short_codes),
                                               test::any_byte(), read_file);
}

}  // namespace
}  // namespace lamplock::dxf_areas_test
