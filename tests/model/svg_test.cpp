#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "host/geometry/bounds.hpp"
#include "host/model/arc_length.hpp"
#include "host/model/input.hpp"
#include "host/model/read_svg.hpp"
#include "tests/error_of.hpp"
#include "tests/model/damaged_drawing.hpp"
#include "tests/scale.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::svg_test {
namespace {

using geometry::Point;
using model::ArcLength;
using model::Curves;
using model::Path;
using model::read_svg;
using std::numbers::pi;
using test::error_of;
using test::TemporaryFolder;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

double distance(const Point& p, const Point& q) {
  return std::hypot(p.x - q.x, p.y - q.y, p.z - q.z);
}

/// A page of 100 x 80 mm in units of mm: (x, y) of the text is (x, 80 - y) of the drawing.
std::string page(const std::string& content) {
  return "<?xml version=\"1.0\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100mm\" "
         "height=\"80mm\" viewBox=\"0 0 100 80\">\n" +
         content + "\n</svg>\n";
}

class Svg : public ::testing::Test {
 protected:
  Curves read(const std::string& bytes) { return read_svg(folder_.write("a.svg", bytes)); }
  Curves shapes(const std::string& content) { return read(page(content)); }
  Path shape(const std::string& content) {
    const Curves curves = shapes(content);
    EXPECT_EQ(curves.paths.size(), 1u) << content;
    return curves.paths.at(0);
  }
  Path data(const std::string& d) {
    return shape("<path fill='none' stroke='red' d='" + d + "'/>");
  }
  std::string error(const std::string& bytes) {
    const auto path = folder_.write("a.svg", bytes);
    return error_of([&] { read_svg(path); });
  }
  std::string data_error(const std::string& d) { return error(page("<path d='" + d + "'/>")); }

  const TemporaryFolder folder_;
};

void expect_box(const Curves& curves, const Point& low, const Point& high) {
  const auto box = model::bounds(curves);
  EXPECT_LT(distance(box.low, low), 0.002);
  EXPECT_LT(distance(box.high, high), 0.002);
}

TEST_F(Svg, BasicShapesAreUpright) {
  const Path line = shape("<line x1='10' y1='20' x2='13' y2='24'/>");
  EXPECT_LT(distance(model::start_of(line), {10, 60, 0}), 1e-9);
  EXPECT_LT(distance(model::end_of(line), {13, 56, 0}), 1e-9);
  const Path circle = shape("<circle cx='50' cy='40' r='10'/>");
  EXPECT_TRUE(circle.closed);
  EXPECT_NEAR(ArcLength(circle).total(), 20 * pi, 1e-8);
  EXPECT_NEAR(ArcLength(shape("<ellipse cx='5' cy='4' rx='1' ry='2'/>")).total(),
              9.68844822054767619, 1e-8);
  const Path rectangle = shape("<rect x='10' y='20' width='30' height='5'/>");
  EXPECT_TRUE(rectangle.closed);
  EXPECT_EQ(rectangle.pieces.size(), 4u);
  EXPECT_NEAR(ArcLength(rectangle).total(), 70, 1e-9);
  EXPECT_NEAR(ArcLength(shape("<rect width='30' height='10' rx='2'/>")).total(), 80 - 16 + 4 * pi,
              1e-8);
  // Radii are limited to half a side: a circle.
  EXPECT_NEAR(ArcLength(shape("<rect width='10' height='10' ry='99'/>")).total(), 10 * pi, 1e-8);
  EXPECT_NEAR(
      ArcLength(shape("<polyline fill='none' stroke='red' points='0,0 3,4 3 14'/>")).total(), 15,
      1e-9);
  const Path triangle = shape("<polygon points='0,0 3,0 3,4'/>");
  EXPECT_TRUE(triangle.closed);
  EXPECT_NEAR(ArcLength(triangle).total(), 12, 1e-9);
}

TEST_F(Svg, RoundedRectanglesAreOneClosedCurve) {
  const Path path = shape("<rect x='5' y='6' width='30' height='10' rx='3' ry='2'/>");
  ASSERT_EQ(path.pieces.size(), 8u);
  for (std::size_t i = 0; i < 8; ++i) {
    const auto &piece = path.pieces[i], &next = path.pieces[(i + 1) % 8];
    EXPECT_LT(distance(model::motion_at(piece, model::range_of(piece).to).at,
                       model::motion_at(next, model::range_of(next).from).at),
              1e-9);
  }
  Curves curves;
  curves.paths = {path};
  expect_box(curves, {5, 64, 0}, {35, 74, 0});
}

// A fill closes each open path; a stroke does not.
TEST_F(Svg, FilledOpenPathsAreClosed) {
  struct Case {
    std::string shape;
    double length_mm;
    std::size_t closed;
  };
  const double corner = 20 + std::hypot(10, 10);
  for (const Case& one : std::vector<Case>{
           {"<path d='M5 5H15V15'/>", corner, 1},
           {"<path d='M5 5H15V15' fill='red'/>", corner, 1},
           {"<path d='M5 5H15V15' fill='red' stroke='blue'/>", corner, 1},
           {"<path d='M5 5H15V15' stroke='blue'/>", corner, 1},
           {"<path d='M5 5H15V15' fill='white'/>", corner, 1},
           {"<path d='M5 5H15V15M30 5H40V15M50 5H60V15H50Z'/>", 2 * corner + 40, 3},
           {"<polyline points='5 5 15 5 15 15'/>", corner, 1},
           {"<path d='M30 30A10 10 0 0 1 50 30' fill='red'/>", 10 * pi + 20, 1},
           {"<path d='M5 5C5 5 15 5 15 5Q15 15 15 15' fill='red'/>", corner, 1},
           {"<path d='M5 5H15V15' fill='none' stroke='blue'/>", 20, 0},
           {"<path d='M5 5H15V15' fill='red' fill-opacity='0' stroke='blue'/>", 20, 0},
           {"<polyline points='5 5 15 5 15 15' fill='none' stroke='blue'/>", 20, 0},
           // White on white is no edge.
           {"<path d='M5 5H15V15' fill='white' stroke='blue'/>", 20, 0},
           // Straight lines have no area, in any direction.
           {"<path d='M5 5H15M5 7H20H15'/>", 30, 0},
           {"<path transform='rotate(33)' d='M5 5L15 12L25 19' fill='red'/>", 2 * std::hypot(10, 7),
            0},
           {"<path d='M5 5C7 5 9 5 15 5' fill='red'/>", 10, 0},
           {"<line x1='5' x2='15' fill='red'/>", 10, 0}}) {
    const Curves curves = shapes(one.shape);
    double length = 0;
    for (const Path& path : curves.paths) length += ArcLength(path).total();
    EXPECT_NEAR(length, one.length_mm, 1e-5) << one.shape;
    EXPECT_EQ(static_cast<std::size_t>(std::count_if(curves.paths.begin(), curves.paths.end(),
                                                     [](const Path& path) { return path.closed; })),
              one.closed)
        << one.shape;
  }
}

TEST_F(Svg, PathsSupportAllCommands) {
  EXPECT_NEAR(ArcLength(data("M10 10 L13 14 H20 V20")).total(), 5 + 7 + 6, 1e-9);
  EXPECT_NEAR(ArcLength(data("m10 10 3 4 h7 v6 l-1-2")).total(), 18 + std::sqrt(5.0), 1e-9);
  const Path closed = data("M0 0h3v4z");
  EXPECT_TRUE(closed.closed);
  EXPECT_NEAR(ArcLength(closed).total(), 12, 1e-9);
  // A parabola as Q, as the equivalent cubic, and its mirror image by T.
  const double parabola = std::sqrt(5.0) / 2 + std::asinh(2.0) / 4;
  EXPECT_NEAR(ArcLength(data("M0 0Q.5 0 1 1")).total(), parabola, 1e-9);
  EXPECT_NEAR(ArcLength(data("M0 0q.5 0 1 1t1 1")).total(), 2 * parabola, 1e-9);
  EXPECT_NEAR(
      ArcLength(data("M0 0C.3333333333333333 0 .6666666666666666 .3333333333333333 1 1")).total(),
      parabola, 1e-9);
  // S and T mirror only the control point of their own kind.
  EXPECT_NEAR(ArcLength(data("M0 0C0 1 1 1 1 0S2-1 2 0")).total(),
              2 * ArcLength(data("M0 0C0 1 1 1 1 0")).total(), 1e-9);
  EXPECT_NEAR(ArcLength(data("M0 0Q1 1 2 0T4 0")).total(),
              2 * ArcLength(data("M0 0Q1 1 2 0")).total(), 1e-9);
  EXPECT_NEAR(ArcLength(data("M0 0C0 1 1 1 1 0T4 4")).total(),
              ArcLength(data("M0 0C0 1 1 1 1 0")).total() + 5, 1e-9);
  EXPECT_NEAR(ArcLength(data("M0 0L5 5T8 9")).total(), std::sqrt(50.0) + 5, 1e-9);
  const Curves two = shapes("<path d='M0 0 H1 M5 5 m1 1 h2 z l0 3'/>");
  ASSERT_EQ(two.paths.size(), 3u);
  EXPECT_LT(distance(model::start_of(two.paths[2]), {6, 74, 0}), 1e-9);
}

TEST_F(Svg, ArcsHaveTheFourChoices) {
  // Half axes 5 and 5, chord of 6: centres 4 off the chord; sweep 1 is clockwise on the page.
  const double small = 2 * std::asin(0.6) * 5, large = 10 * pi - small;
  const auto top = [&](const std::string& d) {
    Curves curves;
    curves.paths = {data(d)};
    return model::bounds(curves);
  };
  EXPECT_NEAR(ArcLength(data("M10 40A5 5 0 0 1 16 40")).total(), small, 1e-9);
  EXPECT_NEAR(ArcLength(data("M10 40A5 5 0 1 1 16 40")).total(), large, 1e-9);
  EXPECT_NEAR(top("M10 40A5 5 0 0 1 16 40").high.y, 41, 1e-6);
  EXPECT_NEAR(top("M10 40A5 5 0 0 0 16 40").low.y, 39, 1e-6);
  EXPECT_NEAR(top("M10 40A5 5 0 1 1 16 40").high.y, 49, 1e-6);
  EXPECT_NEAR(top("M10 40a5 5 0 106 0").low.y, 31, 1e-6);  // flags need no blanks
  // Radii that are too small grow until the chord is a diameter.
  EXPECT_NEAR(ArcLength(data("M10 40A1 1 0 0 1 20 40")).total(), 5 * pi, 1e-8);
  EXPECT_NEAR(ArcLength(data("M10 40A0 5 0 0 1 20 40")).total(), 10, 1e-9);
}

// Any arc ends at its given point, and its points satisfy the equation of its ellipse.
TEST_F(Svg, ArcsGoThroughTheirEnds) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> place(1, 99), radius(1, 90), turn(-400, 400);
  for (int i = 0; i < test::scaled(200); ++i) {
    const double x1 = place(random), y1 = place(random), x2 = place(random), y2 = place(random);
    const Path path =
        data(fmt::format("M{} {}A{} {} {} {} {} {} {}", x1, y1, radius(random), radius(random),
                         turn(random), random() % 2, random() % 2, x2, y2));
    EXPECT_LT(distance(model::start_of(path), {x1, 80 - y1, 0}), 1e-8);
    EXPECT_LT(distance(model::end_of(path), {x2, 80 - y2, 0}), 1e-8);
  }
}

TEST_F(Svg, PagesAndUnits) {
  const auto width = [&](const std::string& size, const std::string& line) {
    const Curves curves = read("<svg " + size + "><line x2='" + line + "'/></svg>");
    return ArcLength(curves.paths.at(0)).total();
  };
  EXPECT_NEAR(width("", "96"), 25.4, 1e-9);
  EXPECT_NEAR(width("viewBox='0 0 50 50'", "96"), 25.4, 1e-9);
  EXPECT_NEAR(width("width='100%' height='100%' viewBox='0 0 50 50'", "96"), 25.4, 1e-9);
  EXPECT_NEAR(width("width='50mm' height='50mm'", "1in"), 25.4, 1e-9);
  EXPECT_NEAR(width("width='50mm' height='50mm'", "50%"), 25, 1e-9);
  EXPECT_NEAR(width("width='1in' height='1in' viewBox='0 0 72 72'", "7.2e1"), 25.4, 1e-9);
  EXPECT_NEAR(width("", "1cm"), 10, 1e-9);
  EXPECT_NEAR(width("", "72pt"), 25.4, 1e-9);
  EXPECT_NEAR(width("", "6pc"), 25.4, 1e-9);
  EXPECT_NEAR(width("", "40Q"), 10, 1e-9);
  // The view is centred on a page of another shape, or aligned as requested.
  const auto box = [&](const std::string& aspect) {
    return model::bounds(read("<svg width='20mm' height='10mm' viewBox='0 0 1 1' " + aspect +
                              "><rect width='1' height='1'/></svg>"));
  };
  EXPECT_NEAR(box("").low.x, 5, 1e-9);
  EXPECT_NEAR(box("").high.y, 10, 1e-9);
  EXPECT_NEAR(box("preserveAspectRatio='xMaxYMid'").low.x, 10, 1e-9);
  EXPECT_NEAR(box("preserveAspectRatio='none'").high.x, 20, 1e-9);
  EXPECT_NEAR(box("preserveAspectRatio='xMidYMin slice'").low.y, -10, 1e-9);
}

// The page is a replaced element of CSS: a missing side follows from the ratio of the view.
TEST_F(Svg, AMissingSideOfThePageFollowsFromTheView) {
  const auto box = [&](const std::string& size) {
    return model::bounds(
        read("<svg " + size +
             " viewBox='10 20 60 30'><rect x='10' y='20' width='60' height='30'/></svg>"));
  };
  for (const std::string size :
       {"width='60mm'", "height='30mm'", "width='100%' height='30mm'", "width='60mm' height='100%'",
        "width='auto' height='3cm'", "width='60mm' height='auto'", "width='50%' height='30mm'",
        "style='height:30mm'", "style='width:100%' height='30mm'", "height='30mm' width='100vw'"}) {
    EXPECT_NEAR(box(size).low.x, 0, 1e-9) << size;
    EXPECT_NEAR(box(size).low.y, 0, 1e-9) << size;
    EXPECT_NEAR(box(size).high.x, 60, 1e-9) << size;
    EXPECT_NEAR(box(size).high.y, 30, 1e-9) << size;
  }
  constexpr double px = 25.4 / 96;
  for (const std::string size : {"", "width='auto' height='auto'", "width='100%'"})
    EXPECT_NEAR(box(size).high.x, 60 * px, 1e-9) << size;
  for (const std::string size : {"width='50%'", "height='50%'", "width='50%' height='50%'"}) {
    EXPECT_NEAR(box(size).high.x, 30 * px, 1e-9) << size;
    EXPECT_NEAR(box(size).high.y, 15 * px, 1e-9) << size;
  }
}

TEST_F(Svg, TransformsNest) {
  EXPECT_NEAR(ArcLength(shape("<g transform='scale(2)'><g transform='rotate(30) translate(1,2)'>"
                              "<circle r='1'/></g></g>"))
                  .total(),
              4 * pi, 1e-8);
  const auto start = [&](const std::string& transform) {
    return model::start_of(shape("<line transform='" + transform + "' x1='10' x2='9'/>"));
  };
  EXPECT_LT(distance(start("translate(1 2)"), {11, 78, 0}), 1e-9);
  EXPECT_LT(distance(start("translate(1)"), {11, 80, 0}), 1e-9);
  EXPECT_LT(distance(start("rotate(90)"), {0, 70, 0}), 1e-9);
  EXPECT_LT(distance(start("rotate(90 10 0)"), {10, 80, 0}), 1e-9);
  EXPECT_LT(distance(start("rotate(90, 20, 0)"), {20, 90, 0}), 1e-9);
  EXPECT_LT(distance(start("matrix(1 0 0 1 5 6)"), {15, 74, 0}), 1e-9);
  EXPECT_LT(distance(start("skewY(45)"), {10, 70, 0}), 1e-9);
  EXPECT_LT(distance(start("skewX(45)"), {10, 80, 0}), 1e-9);
  EXPECT_LT(distance(start("translate(1,1), scale(2)"), {21, 79, 0}), 1e-9);
  EXPECT_LT(distance(start("scale(2 3) translate(1 1)"), {22, 77, 0}), 1e-9);
}

TEST_F(Svg, UsesSymbolsAndNestedViews) {
  const Curves curves = shapes(
      "<defs><circle id='c' r='1'/><g id='two'><use href='#c'/><use href='#c' x='5'/></g>"
      "<symbol id='s' viewBox='0 0 10 10'><rect width='10' height='10'/></symbol></defs>"
      "<use href='#two' x='10' y='10'/><use xmlns:xlink='x' xlink:href='#two' y='20' "
      "transform='scale(2)'/>"
      "<use href='#s' x='50' y='50' width='20' height='20'/>"
      "<svg x='80' y='0' width='5' height='5' viewBox='0 0 1 1'><line x2='1'/></svg>");
  ASSERT_EQ(curves.paths.size(), 6u);
  EXPECT_LT(distance(model::start_of(curves.paths[1]), {16, 70, 0}), 1e-9);
  EXPECT_LT(distance(model::start_of(curves.paths[3]), {12, 40, 0}), 1e-9);
  EXPECT_NEAR(ArcLength(curves.paths[4]).total(), 80, 1e-9);
  EXPECT_LT(distance(model::start_of(curves.paths[4]), {50, 30, 0}), 1e-9);
  EXPECT_LT(distance(model::end_of(curves.paths[5]), {85, 80, 0}), 1e-9);
}

TEST_F(Svg, LayersAreThoseOfInkscapeOrTheOutermostGroup) {
  const Curves curves = shapes(
      "<line x2='1'/><g id='outer'><g id='inner'><line x2='1'/></g></g>"
      "<g xmlns:inkscape='i' inkscape:groupmode='layer' inkscape:label='Cut' id='g1'>"
      "<g id='deep'><line x2='1'/></g><g inkscape:groupmode='layer' id='g2'><line "
      "x2='1'/></g></g>");
  EXPECT_THAT(curves.layers, ElementsAre("", "outer", "Cut", "g2"));
  for (std::uint32_t i = 0; i < 4; ++i) EXPECT_EQ(curves.paths.at(i).layer, i);
}

TEST_F(Svg, UnreadElementsAreCounted) {
  const Curves curves = shapes(
      "<title>t</title><metadata/><style>x</style><sodipodi:namedview xmlns:sodipodi='s'/>"
      "<!-- c --><text>hello</text><text>x</text><image/><foreignObject/><line x2='1'/>"
      "<g display='none'><line x2='1'/></g><line x2='1' style='fill:red; display: none'/>"
      "<rect width='0' height='5'/><circle r='0'/><path d=''/><path d='M1 1'/><polyline points=''/>"
      "<line visibility='hidden' x2='1'/><use href='other.svg#x'/>");
  EXPECT_EQ(curves.paths.size(), 1u);
  EXPECT_THAT(curves.left_out,
              ElementsAre(Pair("foreignObject", 1u), Pair("hidden", 3u), Pair("image", 1u),
                          Pair("text", 2u), Pair("use of another file", 1u)));
}

TEST_F(Svg, ErrorsNameTheLine) {
  EXPECT_THAT(error(""), HasSubstr("empty"));
  EXPECT_THAT(error("hello"), HasSubstr("not valid XML"));
  EXPECT_THAT(error(page("<g>\n<line x2='1'/>")), HasSubstr("not valid XML"));
  EXPECT_THAT(error("<html/>"), HasSubstr("line 1: the document is 'html', not svg"));
  EXPECT_THAT(error(page("")), HasSubstr("the drawing is empty"));
  EXPECT_THAT(error(page("<text/>")), HasSubstr("left out: 1 text"));
  EXPECT_THAT(data_error("L1 1"), HasSubstr("line 3: the path data do not begin with M"));
  EXPECT_THAT(data_error("M1"), HasSubstr("line 3: a number is missing at the end"));
  EXPECT_THAT(data_error("M1 1X"), HasSubstr("command"));
  EXPECT_THAT(data_error("M1 1 L nan 1"), HasSubstr("a number is missing"));
  EXPECT_THAT(data_error("M1 1 L 1e999 1"), HasSubstr("not a usable number"));
  EXPECT_THAT(data_error("M1 1 L 1e30 1"), HasSubstr("line 3: a coordinate"));
  EXPECT_THAT(data_error("M0 0A1 1 0 2 0 5 5"), HasSubstr("flag"));
  EXPECT_THAT(error(page("\n<circle r='-1'/>")), HasSubstr("line 4: the radii -1"));
  EXPECT_THAT(error(page("<rect width='-1' height='1'/>")), HasSubstr("the size -1"));
  EXPECT_THAT(error(page("<line x2='3lh'/>")), HasSubstr("not a length"));
  EXPECT_THAT(error(page("<g transform='spin(3)'/>")), HasSubstr("transform"));
  EXPECT_THAT(error(page("<g transform='rotate(3 4)'/>")), HasSubstr("rotate has the wrong"));
  EXPECT_THAT(error(page("<g transform='scale(1'/>")), HasSubstr("scale has the wrong"));
  EXPECT_THAT(error(page("<polygon points='1 2 3'/>")), HasSubstr("3 coordinates"));
  EXPECT_THAT(error(page("<use href='#missing'/>")), HasSubstr("no element 'missing'"));
  EXPECT_THAT(error(page("<svg viewBox='0 0 0 5'/>")), HasSubstr("viewBox"));
  EXPECT_THAT(error("<svg viewBox='0 0 5'/>"), HasSubstr("viewBox"));
  EXPECT_THAT(error("<svg width='0' height='5' viewBox='0 0 5 5'/>"),
              HasSubstr("the page has the size 0"));
}

TEST_F(Svg, DrawingsThatExplodeAreRefused) {
  EXPECT_THAT(error(page("<g id='a'><use href='#a'/></g>")), HasSubstr("'a' uses itself"));
  EXPECT_THAT(error(page("<g id='a'><use href='#b'/></g><g id='b'><use href='#a'/></g>")),
              HasSubstr("uses itself"));
  std::string doubling = "<g id='u0'/>", nested;
  for (int i = 1; i <= 40; ++i) {
    const std::string inner = fmt::format("<use href='#u{}'/>", i - 1);
    doubling += fmt::format("<g id='u{}'>{}{}</g>", i, inner, inner);
  }
  EXPECT_THAT(error(page("<defs>" + doubling + "</defs><use href='#u40'/>")), HasSubstr("pieces"));
  for (int i = 0; i < 100'000; ++i) nested += "<g>";
  EXPECT_THAT(error("<svg>" + nested), HasSubstr("not valid XML"));
  std::string closing;
  for (int i = 0; i < 100'000; ++i) closing += "</g>";
  EXPECT_THAT(error(page(nested + closing)), HasSubstr("deeper than"));
}

TEST_F(Svg, DamagedFilesAtWorstFail) {
  const std::string whole = page(
      "<g transform='translate(1,2) rotate(30)'><path d='M1 2L3 4C1 2 3 4 5 6S7 8 9 1Q1 2 3 4T5 "
      "6A3 "
      "4 30 0 1 9 9Z'/><rect id='r' width='30' height='20' rx='3'/></g><use href='#r' x='5'/>"
      "<ellipse cx='5' cy='5' rx='5mm' ry='3'/><polygon points='1,2 3,4 5,7'/>");
  ASSERT_EQ(read(whole).paths.size(), 5u);
  test::expect_damaged_drawings_fail_at_most(folder_, "a.svg", whole,
                                             "0123456789.-+eE <>/='\"#MLCZ\n\xFF",
                                             [](const auto& path) { return read_svg(path); });
}

TEST_F(Svg, IsADrawing) {
  const auto path = folder_.write("a.SVG", page("<rect width='1' height='1'/>"));
  EXPECT_EQ(std::get<Curves>(model::read_input(path)).paths.size(), 1u);
}

}  // namespace
}  // namespace lamplock::svg_test
