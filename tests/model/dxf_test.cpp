#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <sstream>
#include <string>

#include "host/geometry/bounds.hpp"
#include "host/model/arc_length.hpp"
#include "host/model/input.hpp"
#include "host/model/read_dxf.hpp"
#include "host/model/read_points.hpp"
#include "host/model/spline.hpp"
#include "tests/error_of.hpp"
#include "tests/model/damaged_drawing.hpp"
#include "tests/scale.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::dxf_test {
namespace {

using geometry::Point;
using model::Arc;
using model::ArcLength;
using model::Curves;
using model::Line;
using model::Path;
using model::read_dxf;
using std::numbers::pi;
using test::error_of;
using test::TemporaryFolder;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

double distance(const Point& p, const Point& q) {
  return std::hypot(p.x - q.x, p.y - q.y, p.z - q.z);
}

/// Group codes and values separated by blanks, converted to one per line.
std::string lines(const std::string& groups) {
  std::istringstream words(groups);
  std::string text, code, value;
  while (words >> code >> value)
    text.append("  ").append(code).append("\n").append(value).append("\n");
  return text;
}

std::string section(const std::string& name, const std::string& groups) {
  return lines("0 SECTION 2 " + name + " " + groups + " 0 ENDSEC");
}

std::string drawing(const std::string& entities, const std::string& before = "") {
  return before + section("ENTITIES", entities) + lines("0 EOF");
}

class Dxf : public ::testing::Test {
 protected:
  Curves read(const std::string& bytes) { return read_dxf(folder_.write("a.dxf", bytes)); }
  Curves read_entities(const std::string& entities) { return read(drawing(entities)); }
  /// The only curve of a drawing.
  Path curve(const std::string& entities) {
    const Curves curves = read_entities(entities);
    EXPECT_EQ(curves.paths.size(), 1u);
    return curves.paths.at(0);
  }
  std::string error(const std::string& bytes) {
    const auto path = folder_.write("a.dxf", bytes);
    return error_of([&] { read_dxf(path); });
  }
  std::string entity_error(const std::string& entities) { return error(drawing(entities)); }

  const TemporaryFolder folder_;
};

TEST_F(Dxf, LinesAndPointsWithTheirLayers) {
  const Curves curves = read_entities(
      "0 LINE 8 outline 10 1 20 2 30 3 11 4 21 5 31 6 0 POINT 8 dots 10 7 20 8 30 9 "
      "0 LINE 8 outline 10 0 20 0 11 1 21 0 0 LINE 10 0 20 0 11 1 21 0");
  ASSERT_EQ(curves.paths.size(), 3u);
  const auto& line = std::get<Line>(curves.paths[0].pieces.at(0));
  EXPECT_EQ(line.from, (Point{1, 2, 3}));
  EXPECT_EQ(line.to, (Point{4, 5, 6}));
  EXPECT_FALSE(curves.paths[0].closed);
  EXPECT_EQ(curves.points, (geometry::PointCloud{{7, 8, 9}}));
  EXPECT_THAT(curves.layers, ElementsAre("outline", "0"));
  EXPECT_EQ(curves.paths[1].layer, 0u);
  EXPECT_EQ(curves.paths[2].layer, 1u);
}

TEST_F(Dxf, ArcsGoCounterClockwiseThroughZero) {
  const Path arc = curve("0 ARC 10 1 20 2 40 5 50 270 51 90");
  EXPECT_NEAR(ArcLength(arc).total(), 5 * pi, 1e-9);
  EXPECT_LT(distance(model::start_of(arc), {1, -3, 0}), 1e-12);
  EXPECT_LT(distance(model::end_of(arc), {1, 7, 0}), 1e-12);
  ArcLength along(arc);
  EXPECT_LT(distance(along.at(2.5 * pi), {6, 2, 0}), 1e-9);
  EXPECT_NEAR(ArcLength(curve("0 ARC 10 0 20 0 40 1 50 0 51 360")).total(), 2 * pi, 1e-9);
  EXPECT_NEAR(ArcLength(curve("0 ARC 10 0 20 0 40 1 50 -30 51 690")).total(), 2 * pi, 1e-9);
  EXPECT_TRUE(curve("0 ARC 10 0 20 0 40 1 50 0 51 360").closed);
}

TEST_F(Dxf, CirclesAndEllipses) {
  const Path circle = curve("0 CIRCLE 10 1 20 2 30 3 40 5");
  EXPECT_TRUE(circle.closed);
  EXPECT_NEAR(ArcLength(circle).total(), 10 * pi, 1e-9);
  const Path ellipse = curve("0 ELLIPSE 10 0 20 0 11 0 21 2 40 0.5 41 0 42 6.283185307179586");
  EXPECT_TRUE(ellipse.closed);
  EXPECT_NEAR(ArcLength(ellipse).total(), 9.68844822054767619, 1e-9);
  const Path quarter = curve("0 ELLIPSE 10 0 20 0 11 2 21 0 40 0.5 41 0 42 1.5707963267948966");
  EXPECT_FALSE(quarter.closed);
  EXPECT_LT(distance(model::end_of(quarter), {0, 1, 0}), 1e-12);
}

// A bulge is the tangent of a quarter of the angle for any chord: the arc's length is radius times
// angle and its middle is off the chord by bulge * chord / 2.
TEST_F(Dxf, BulgesAreArcs) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> place(-20, 20), turn(-3.5, 3.5);
  for (int i = 0; i < test::scaled(100); ++i) {
    const Point p{place(random), place(random), 0}, q{place(random), place(random), 0};
    const double bulge = turn(random);
    std::ostringstream entity;
    entity.precision(17);
    entity << "0 LWPOLYLINE 90 2 70 0 10 " << p.x << " 20 " << p.y << " 42 " << bulge << " 10 "
           << q.x << " 20 " << q.y;
    const Path path = curve(entity.str());
    const double chord = distance(p, q), angle = 4 * std::atan(bulge);
    const double radius = chord / 2 / std::abs(std::sin(angle / 2));
    EXPECT_LT(distance(model::start_of(path), p), 1e-9);
    EXPECT_LT(distance(model::end_of(path), q), 1e-9);
    ArcLength along(path);
    EXPECT_NEAR(along.total(), radius * std::abs(angle), 1e-8 * along.total());
    // Positive bulges turn counter-clockwise, to the right of the chord.
    const Point middle{(p.x + q.x) / 2 + bulge / 2 * (q.y - p.y),
                       (p.y + q.y) / 2 - bulge / 2 * (q.x - p.x), 0};
    EXPECT_LT(distance(along.at(along.total() / 2), middle), 1e-8 * (1 + radius));
  }
}

TEST_F(Dxf, PolylinesOfBothKinds) {
  // A slot: two lines and two half circles.
  const std::string corners = "10 0 20 0 10 10 20 0 42 1 10 10 20 4 10 0 20 4 42 1";
  const Path slot = curve("0 LWPOLYLINE 90 4 70 1 38 2.5 " + corners);
  EXPECT_TRUE(slot.closed);
  EXPECT_EQ(slot.pieces.size(), 4u);
  EXPECT_NEAR(ArcLength(slot).total(), 20 + 4 * pi, 1e-9);
  EXPECT_EQ(model::start_of(slot).z, 2.5);
  const Path old = curve(
      "0 POLYLINE 66 1 70 1 10 0 20 0 30 2.5 0 VERTEX 10 0 20 0 0 VERTEX 10 10 20 0 42 1 "
      "0 VERTEX 10 10 20 4 0 VERTEX 10 0 20 4 42 1 0 SEQEND");
  EXPECT_TRUE(old.closed);
  EXPECT_NEAR(ArcLength(old).total(), ArcLength(slot).total(), 1e-12);
  EXPECT_EQ(model::start_of(old).z, 2.5);
  const Path in_space =
      curve("0 POLYLINE 66 1 70 8 0 VERTEX 10 0 20 0 30 1 42 1 0 VERTEX 10 0 20 3 30 5 0 SEQEND");
  EXPECT_NEAR(ArcLength(in_space).total(), 5, 1e-12);
  // Closed without the flag; coincident corners.
  EXPECT_TRUE(curve("0 LWPOLYLINE 70 0 10 0 20 0 10 1 20 0 10 1 20 0 10 1 20 1 10 0 20 0").closed);
  // The control frame of a fitted spline is not on the curve.
  const Path fitted = curve(
      "0 POLYLINE 66 1 70 4 0 VERTEX 10 0 20 0 70 8 0 VERTEX 10 1 20 9 70 16 "
      "0 VERTEX 10 2 20 0 70 8 0 SEQEND");
  EXPECT_EQ(fitted.pieces.size(), 1u);
}

TEST_F(Dxf, Splines) {
  const Path bezier = curve(
      "0 SPLINE 70 8 71 2 72 6 73 3 40 0 40 0 40 0 40 1 40 1 40 1 "
      "10 0 20 0 30 0 10 0.5 20 0 30 0 10 1 20 1 30 0");
  EXPECT_NEAR(ArcLength(bezier).total(), std::sqrt(5.0) / 2 + std::asinh(2.0) / 4, 1e-9);
  // A full circle of four rational quarters.
  const Path circle = curve(
      "0 SPLINE 70 13 71 2 72 12 73 9 40 0 40 0 40 0 40 1 40 1 40 2 40 2 40 3 40 3 40 4 40 4 40 4 "
      "41 1 41 .70710678118654752 41 1 41 .70710678118654752 41 1 41 .70710678118654752 41 1 "
      "41 .70710678118654752 41 1 "
      "10 1 20 0 10 1 20 1 10 0 20 1 10 -1 20 1 10 -1 20 0 10 -1 20 -1 10 0 20 -1 10 1 20 -1 10 1 "
      "20 0");
  EXPECT_TRUE(circle.closed);
  EXPECT_NEAR(ArcLength(circle).total(), 2 * pi, 1e-9);
  for (const Point& p : model::flattened(circle)) EXPECT_NEAR(std::hypot(p.x, p.y), 1, 1e-12);
}

TEST_F(Dxf, FacesThatPointDownAreMirrored) {
  // Extrusion (0, 0, -1): x of the entity is -x of the world.
  const Path arc = curve("0 ARC 10 1 20 2 30 4 40 1 50 0 51 90 210 0 220 0 230 -1");
  EXPECT_LT(distance(model::start_of(arc), {-2, 2, -4}), 1e-12);
  EXPECT_LT(distance(model::end_of(arc), {-1, 3, -4}), 1e-12);
  // Extrusion along y: the arbitrary axes are -x and z.
  const Path side = curve("0 ARC 10 1 20 2 30 4 40 1 50 0 51 90 210 0 220 1 230 0");
  EXPECT_LT(distance(model::start_of(side), {-2, 4, 2}), 1e-12);
  EXPECT_LT(distance(model::end_of(side), {-1, 4, 3}), 1e-12);
}

TEST_F(Dxf, UnitsBecomeMillimetres) {
  const auto length = [&](const std::string& unit) {
    const Curves curves =
        read(drawing("0 LINE 10 0 20 0 11 1 21 0",
                     section("HEADER", "9 $ACADVER 1 AC1021 9 $INSUNITS 70 " + unit)));
    return ArcLength(curves.paths.at(0)).total();
  };
  EXPECT_DOUBLE_EQ(length("0"), 1);
  EXPECT_DOUBLE_EQ(length("1"), 25.4);
  EXPECT_DOUBLE_EQ(length("2"), 304.8);
  EXPECT_DOUBLE_EQ(length("4"), 1);
  EXPECT_DOUBLE_EQ(length("5"), 10);
  EXPECT_DOUBLE_EQ(length("6"), 1000);
  EXPECT_DOUBLE_EQ(length("13"), 0.001);
  EXPECT_NEAR(length("21"), 304.8006096, 1e-7);
  EXPECT_THAT(error(drawing("", section("HEADER", "9 $INSUNITS 70 19"))),
              HasSubstr("line 8: $INSUNITS"));
}

TEST_F(Dxf, BlocksAreInsertedTurnedScaledAndInArrays) {
  const std::string blocks =
      section("BLOCKS",
              "0 BLOCK 2 Inner 10 1 20 1 0 LINE 8 0 10 1 20 1 11 2 21 1 0 ENDBLK "
              "0 BLOCK 2 OUTER 10 0 20 0 0 INSERT 8 0 2 inner 10 5 20 0 50 90 "
              "0 CIRCLE 8 holes 10 0 20 0 40 1 0 ENDBLK");
  const Curves curves = read(drawing(
      "0 INSERT 8 parts 2 Outer 10 100 20 0 41 2 42 2 43 2 50 90 70 3 71 2 44 20 45 10", blocks));
  ASSERT_EQ(curves.paths.size(), 12u);
  EXPECT_THAT(curves.layers, ElementsAre("parts", "holes"));
  // In the outer block the inner line goes from (5, 0) to (5, 1). Scaled by 2: (10, 0), (10, 2);
  // turned by 90 degrees: (0, 10), (-2, 10). Columns step to +y, rows to -x.
  std::size_t i = 0;
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 3; ++column) {
      const Path& line = curves.paths[i];
      const Point corner{100.0 - 10 * row, 20.0 * column, 0};
      EXPECT_LT(distance(model::start_of(line), {corner.x, corner.y + 10, 0}), 1e-9);
      EXPECT_LT(distance(model::end_of(line), {corner.x - 2, corner.y + 10, 0}), 1e-9);
      EXPECT_EQ(curves.layers[line.layer], "parts");
      EXPECT_NEAR(ArcLength(curves.paths[i + 1]).total(), 4 * pi, 1e-9);
      EXPECT_EQ(curves.layers[curves.paths[i + 1].layer], "holes");
      i += 2;
    }
  }
}

TEST_F(Dxf, UnevenScalesMakeEllipses) {
  const std::string blocks =
      section("BLOCKS", "0 BLOCK 2 B 10 0 20 0 0 CIRCLE 10 0 20 0 40 1 0 ENDBLK");
  const Curves curves = read(drawing("0 INSERT 2 B 10 0 20 0 41 2 42 -1", blocks));
  EXPECT_NEAR(ArcLength(curves.paths.at(0)).total(), 9.68844822054767619, 1e-9);
}

TEST_F(Dxf, UnreadEntitiesAreCounted) {
  const std::string tables =
      section("TABLES",
              "0 TABLE 2 LAYER 0 LAYER 2 Off 70 0 62 -7 0 LAYER 2 frozen 70 1 62 7 "
              "0 LAYER 2 seen 70 0 62 7 0 ENDTAB");
  const std::string blocks =
      section("BLOCKS",
              "0 BLOCK 2 B 10 0 20 0 0 TEXT 1 never 0 ENDBLK 0 BLOCK 2 C 10 0 20 0 "
              "0 HATCH 8 0 0 LINE 8 0 10 0 20 0 11 1 21 0 0 ENDBLK");
  const Curves curves =
      read(drawing("0 LINE 8 seen 10 0 20 0 11 1 21 0 0 LINE 8 OFF 10 0 20 0 11 1 21 0 "
                   "0 LINE 8 frozen 10 0 20 0 11 1 21 0 0 LINE 60 1 10 0 20 0 11 1 21 0 "
                   "0 LINE 67 1 10 0 20 0 11 1 21 0 0 TEXT 1 hello 0 TEXT 1 world 0 MTEXT 1 x "
                   "0 SPLINE 71 3 11 0 21 0 11 1 21 1 0 LWPOLYLINE 10 1 20 1 10 1 20 1 "
                   "0 INSERT 2 C 10 0 20 0 66 1 0 ATTRIB 1 x 0 SEQEND 0 INSERT 8 off 2 C 10 0 20 0 "
                   "0 POLYLINE 70 64 0 VERTEX 10 0 20 0 0 SEQEND",
                   tables + blocks));
  EXPECT_EQ(curves.paths.size(), 2u);
  EXPECT_THAT(curves.left_out, ElementsAre(Pair("ATTRIB", 1u), Pair("HATCH", 1u), Pair("MTEXT", 1u),
                                           Pair("POLYLINE", 1u), Pair("SPLINE without poles", 1u),
                                           Pair("TEXT", 2u), Pair("curve without length", 1u),
                                           Pair("hidden", 5u), Pair("paper space", 1u)));
}

TEST_F(Dxf, VariantsOfTheFormat) {
  std::string text = "999\na comment\n" + drawing("0 LINE 10 +1e1 20 .5 11 -2. 21 0");
  EXPECT_EQ(model::start_of(read(text).paths.at(0)), (Point{10, 0.5, 0}));
  std::string windows;
  for (const char c : text) windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(model::start_of(read("\xEF\xBB\xBF" + windows).paths.at(0)), (Point{10, 0.5, 0}));
  // Values with blanks, empty values, unused sections.
  EXPECT_EQ(read(section("CLASSES", "0 CLASS 1 x") +
                 "0\nSECTION\n2\nENTITIES\n0\nLINE\n  8\n my layer \n"
                 " 10\n 1\n 6\n\n 20\n2\n 11\n3\n 21\n4\n0\nENDSEC\n0\nEOF\n")
                .layers.at(0),
            "my layer");
}

TEST_F(Dxf, ErrorsNameTheLine) {
  EXPECT_THAT(error("AC1032" + std::string(100, '\0')), HasSubstr("DWG"));
  EXPECT_THAT(error(""), HasSubstr("empty"));
  EXPECT_THAT(error("hello\nworld\n"), HasSubstr("line 1: 'hello' is not a group code"));
  EXPECT_THAT(entity_error(""), HasSubstr("the drawing is empty"));
  EXPECT_THAT(entity_error("0 TEXT 1 x"), HasSubstr("left out: 1 TEXT"));
  EXPECT_THAT(entity_error("0 LINE 10 0 20 1.5.2 11 1 21 1"), HasSubstr("line 10: '1.5.2'"));
  EXPECT_THAT(entity_error("0 LINE 10 nan"), HasSubstr("'nan' is not a usable number"));
  EXPECT_THAT(entity_error("0 LINE 10 1e999"), HasSubstr("'1e999'"));
  EXPECT_THAT(entity_error("0 LINE 10 1e12"), HasSubstr("line 6: a coordinate"));
  EXPECT_THAT(entity_error("0 ARC 40 1 50 1e300"), HasSubstr("line 6"));
  EXPECT_THAT(entity_error("0 LWPOLYLINE 70 x 10 0 20 0"), HasSubstr("'x' is not a usable whole"));
  EXPECT_THAT(entity_error("0 CIRCLE 10 0 20 0 40 0"), HasSubstr("its radius is 0"));
  EXPECT_THAT(entity_error("0 ELLIPSE 10 0 20 0 11 0 21 0 40 1"),
              HasSubstr("ellipse has no extent"));
  EXPECT_THAT(entity_error("0 CIRCLE 10 0 20 0 40 1 210 0 220 0 230 0"), HasSubstr("extrusion"));
  EXPECT_THAT(entity_error("0 SPLINE 71 3 10 0 20 0 40 1"), HasSubstr("1 knots for 1 poles"));
  EXPECT_THAT(entity_error("0 INSERT 2 missing 10 0 20 0"), HasSubstr("no block 'missing'"));
  EXPECT_THAT(error("0\nLINE\n0\nEOF\n"), HasSubstr("outside of a section"));
  EXPECT_THAT(error(lines("0 SECTION 2 ENTITIES 0 LINE 0 EOF")), HasSubstr("cut off"));
  EXPECT_THAT(error_of([&] { read_dxf(folder_.file("none.dxf")); }), HasSubstr("no such file"));
}

TEST_F(Dxf, BlocksThatExplodeAreRefused) {
  EXPECT_THAT(
      error(drawing("0 INSERT 2 A 10 0 20 0", section("BLOCKS",
                                                      "0 BLOCK 2 A 0 INSERT 2 B 0 ENDBLK "
                                                      "0 BLOCK 2 B 0 INSERT 2 a 0 ENDBLK"))),
      HasSubstr("contains itself"));
  EXPECT_THAT(error(drawing("0 INSERT 2 A 10 0 20 0 70 2000000000 71 2000000000",
                            section("BLOCKS", "0 BLOCK 2 A 0 ENDBLK"))),
              HasSubstr("more than 2000000 pieces"));
  // Each block contains the preceding one twice: 2^40 copies.
  std::string doubling = "0 BLOCK 2 B0 0 ENDBLK ", chain = doubling;
  for (int i = 1; i <= 40; ++i) {
    const std::string inner = "0 INSERT 2 B" + std::to_string(i - 1) + " ";
    doubling.append("0 BLOCK 2 B").append(std::to_string(i)).append(" ");
    doubling.append(inner).append(inner).append("0 ENDBLK ");
  }
  EXPECT_THAT(error(drawing("0 INSERT 2 B40", section("BLOCKS", doubling))), HasSubstr("pieces"));
  for (int i = 1; i <= 100; ++i) {
    chain +=
        "0 BLOCK 2 B" + std::to_string(i) + " 0 INSERT 2 B" + std::to_string(i - 1) + " 0 ENDBLK ";
  }
  EXPECT_THAT(error(drawing("0 INSERT 2 B100", section("BLOCKS", chain))),
              HasSubstr("deeper than"));
}

TEST_F(Dxf, DamagedFilesAtWorstFail) {
  const std::string whole = drawing(
      "0 LINE 8 a 10 1 20 2 11 3 21 4 0 ARC 10 0 20 0 40 2 50 10 51 80 0 ELLIPSE 10 0 20 0 11 2 21 "
      "0 "
      "40 .5 0 LWPOLYLINE 90 3 70 1 10 0 20 0 42 .5 10 3 20 0 10 3 20 3 0 SPLINE 71 2 40 0 40 0 40 "
      "0 "
      "40 1 40 1 40 1 10 0 20 0 10 1 20 0 10 1 20 1 0 INSERT 2 B 10 1 20 1 41 2 70 2 44 5 "
      "0 POINT 10 1 20 1",
      section("HEADER", "9 $INSUNITS 70 4") +
          section("BLOCKS", "0 BLOCK 2 B 10 0 20 0 0 CIRCLE 10 0 20 0 40 1 0 ENDBLK"));
  ASSERT_EQ(read(whole).paths.size(), 7u);
  test::expect_damaged_drawings_fail_at_most(folder_, "a.dxf", whole, "0123456789.-+eE \n\xFFnx",
                                             [](const auto& path) { return read_dxf(path); });
}

TEST_F(Dxf, PointsAloneAreAPointList) {
  const auto points = folder_.write("points.dxf", drawing("0 POINT 10 1 20 2 30 3 0 POINT 10 4"));
  const geometry::PointCloud wanted{{1, 2, 3}, {4, 0, 0}};
  EXPECT_EQ(model::read_point_list(points), wanted);
  EXPECT_EQ(std::get<geometry::PointCloud>(model::read_input(points)), wanted);
  const auto mixed = folder_.write("mixed.dxf", drawing("0 POINT 10 1 0 CIRCLE 40 1"));
  EXPECT_EQ(std::get<Curves>(model::read_input(mixed)).paths.size(), 1u);
  EXPECT_THAT(error_of([&] { model::read_point_list(mixed); }), HasSubstr("curves"));
}

}  // namespace
}  // namespace lamplock::dxf_test
