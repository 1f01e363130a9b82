// Clip paths, masks and dashes of SVG, against what the page shows at many places.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tests/model/svg_page.hpp"
#include "tests/scale.hpp"

namespace lamplock::svg_clip_test {
namespace {

using geometry::Point;
using model::ArcLength;
using model::Curves;
using model::Path;
using std::numbers::pi;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

class SvgClip : public test::SvgPage {
 protected:
  double clipped_length(const std::string& clip, const std::string& shape) {
    return length("<clipPath id='c'>" + clip + "</clipPath><g clip-path='url(#c)'>" + shape +
                  "</g>");
  }
};

TEST_F(SvgClip, CurvesEndAtTheClipPath) {
  EXPECT_NEAR(clipped_length("<rect width='10' height='20'/>", "<circle cx='10' cy='10' r='8'/>"),
              8 * pi, 2e-3);
  EXPECT_NEAR(
      clipped_length("<circle cx='50' cy='40' r='10'/>", "<line y1='40' x2='100' y2='40'/>"), 20,
      2e-3);
  EXPECT_NEAR(clipped_length("<path d='M0 0H50V80H0Z'/>",
                             "<path d='M0 40C33 40 67 40 100 40' fill='none' stroke='red'/>"),
              50, 0.5);
  // The halves of a circle that is cut twice stay closed or become two.
  const Curves two = shapes(
      "<clipPath id='c'><rect y='30' width='99' height='20'/></clipPath>"
      "<circle cx='50' cy='40' r='20' clip-path='url(#c)'/>");
  ASSERT_EQ(two.paths.size(), 2u);
  EXPECT_NEAR(length(two), 4 * 20 * std::asin(0.5), 4e-3);
  for (const Path& path : two.paths) EXPECT_FALSE(path.closed);
}

TEST_F(SvgClip, WhatIsInsideIsNotChanged) {
  for (const std::string clip :
       {"<rect width='100' height='80'/>", "<circle cx='50' cy='40' r='10'/>",
        "<rect x='40' y='30' width='20' height='20'/>"}) {
    const Curves curves = shapes("<clipPath id='c'>" + clip +
                                 "</clipPath><circle cx='50' cy='40' r='10' clip-path='url(#c)'/>");
    ASSERT_EQ(curves.paths.size(), 1u) << clip;
    EXPECT_TRUE(curves.paths[0].closed);
    EXPECT_EQ(curves.paths[0].pieces.size(), 1u);
  }
}

TEST_F(SvgClip, WhatIsOutsideIsNotDrawn) {
  const std::string line = "<line x2='10' y1='5' y2='5'/>";
  for (const std::string clip :
       {"", "<rect x='20' width='5' height='9'/>", "<rect width='50' height='50' display='none'/>",
        "<rect width='50' height='50' visibility='hidden'/>"}) {
    const Curves curves = shapes("<clipPath id='c'>" + clip + "</clipPath><g clip-path='url(#c)'>" +
                                 line + "</g><circle r='1'/>");
    EXPECT_EQ(curves.paths.size(), 1u) << clip;
    EXPECT_THAT(curves.left_out, ElementsAre(Pair("clipped curve", 1u)));
  }
}

TEST_F(SvgClip, AClipPathHasItsOwnTransformsUnitsAndClips) {
  const std::string line = "<line y1='40' x2='100' y2='40'/>";
  EXPECT_NEAR(
      clipped_length("<rect width='10' height='80' transform='translate(5) scale(2 1)'/>", line),
      20, 1e-6);
  EXPECT_NEAR(
      length("<clipPath id='c' transform='scale(3 1)'><use href='#r' x='1'/></clipPath><defs>"
             "<rect id='r' width='10' height='80'/></defs><g clip-path='url(#c)'>" +
             line + "</g>"),
      30, 1e-6);
  EXPECT_NEAR(length("<clipPath id='c' clipPathUnits='objectBoundingBox'><rect width='.5' "
                     "height='1'/></clipPath><rect x='10' y='10' width='20' height='10' "
                     "clip-path='url(#c)'/>"),
              30, 1e-6);
  EXPECT_NEAR(length("<clipPath id='a'><rect width='60' height='80'/></clipPath>"
                     "<clipPath id='b' clip-path='url(#a)'><rect x='20' width='80' height='80'/>"
                     "</clipPath><g clip-path='url(#b)'><g clip-path='url(#d)'>" +
                     line +
                     "</g></g><clipPath id='d'><rect x='30' width='99' height='80' "
                     "clip-path='url(#a)'/></clipPath>"),
              30, 1e-6);
  EXPECT_NEAR(length("<style>.k{clip-path:url('#c')}</style><clipPath id='c'><rect width='7' "
                     "height='80'/></clipPath><g class='k'>" +
                     line + "</g>"),
              7, 1e-6);
  // The clip path moves with its element.
  EXPECT_NEAR(length("<clipPath id='c'><rect width='10' height='80'/></clipPath>"
                     "<g transform='translate(50 0)' clip-path='url(#c)'>" +
                     line + "</g>"),
              10, 1e-6);
  EXPECT_NEAR(length("<g clip-path='url(#missing)'>" + line + "</g>"), 100, 1e-9);
}

TEST_F(SvgClip, FillRulesDecide) {
  const std::string rings = "d='M10 30H50V50H10ZM20 35H40V45H20Z'/>";
  const std::string line = "<line y1='40' x2='100' y2='40'/>";
  EXPECT_NEAR(clipped_length("<path " + rings, line), 40, 1e-6);
  EXPECT_NEAR(clipped_length("<path clip-rule='evenodd' " + rings, line), 20, 1e-6);
}

TEST_F(SvgClip, WhatCannotBeAppliedIsLeftOut) {
  const std::string circle = "<circle r='1'/>";
  for (const std::string clip :
       {"<clipPath id='c'><text>x</text></clipPath><g clip-path='url(#c)'>",
        "<g clip-path='circle(5px)'>", "<g style='clip-path:inset(1px)'>",
        "<mask id='c'><rect width='9' height='9' fill='gray'/></mask><g mask='url(#c)'>",
        "<mask id='c'><image/></mask><g mask='url(#c)'>"}) {
    const Curves curves = shapes(clip + "<line x2='9'/></g>" + circle);
    EXPECT_EQ(curves.paths.size(), 1u) << clip;
    EXPECT_THAT(curves.left_out,
                ElementsAre(Pair("element with a clip path or mask that cannot be applied", 1u)));
  }
  EXPECT_THAT(error("<clipPath id='c' clip-path='url(#c)'><rect/></clipPath>"
                    "<g clip-path='url(#c)'><line x2='9'/></g>"),
              HasSubstr("uses itself"));
  EXPECT_THAT(error("<clipPath id='c'><rect width='1' height='1' clip-path='url(#c)'/></clipPath>"
                    "<g clip-path='url(#c)'><line x2='9'/></g>"),
              HasSubstr("uses itself"));
}

TEST_F(SvgClip, PlainMasksClip) {
  const std::string line = "<line y1='40' x2='100' y2='40'/>";
  EXPECT_NEAR(
      length("<mask id='m' style='mask-type:luminance' maskUnits='userSpaceOnUse' x='0' y='0' "
             "width='30' height='80'><g><path d='M10 0H50V80H10Z' fill='white'/></g></mask>"
             "<g mask='url(#m)'>" +
             line + "</g>"),
      20, 1e-6);
  EXPECT_NEAR(length("<mask id='m' style='mask-type:alpha'><rect width='30' height='80' "
                     "fill='#D9D9D9'/></mask><g mask='url(#m)'>" +
                     line + "</g>"),
              30, 1e-6);
}

// At many places along random curves: inside the random clip paths or not.
TEST_F(SvgClip, EqualsTheDefinitionAtManyPlaces) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> x(5, 95), y(5, 75), size(3, 40);
  using Inside = std::function<bool(const Point&)>;
  const auto clip = [&]() -> std::pair<std::string, Inside> {
    const double a = x(random), b = y(random), w = size(random), h = size(random);
    if (random() % 2 == 0)
      return {fmt::format("<rect x='{}' y='{}' width='{}' height='{}'/>", a, b, w, h),
              [=](const Point& p) {
                return p.x > a && p.x < a + w && 80 - p.y > b && 80 - p.y < b + h;
              }};
    return {fmt::format("<ellipse cx='{}' cy='{}' rx='{}' ry='{}'/>", a, b, w, h),
            [=](const Point& p) { return std::hypot((p.x - a) / w, (80 - p.y - b) / h) < 1; }};
  };
  const auto shape = [&] {
    switch (random() % 4) {
      case 0:
        return fmt::format("<circle cx='{}' cy='{}' r='{}'/>", x(random), y(random), size(random));
      case 1:
        return fmt::format("<path d='M{} {}C{} {} {} {} {} {}Z'/>", x(random), y(random), x(random),
                           y(random), x(random), y(random), x(random), y(random));
      case 2:
        return fmt::format("<path d='M{} {}A{} {} 30 1 0 {} {}'/>", x(random), y(random),
                           size(random), size(random), x(random), y(random));
      default:
        return fmt::format("<polygon points='{},{} {},{} {},{}'/>", x(random), y(random), x(random),
                           y(random), x(random), y(random));
    }
  };
  int cut = 0;
  for (int i = 0; i < test::scaled(120, 12); ++i) {
    const auto first = clip(), second = clip(), outer = clip();
    const std::string drawn = shape();
    const Curves whole = shapes(drawn);
    const Inside inside = [&](const Point& p) {
      return (first.second(p) || second.second(p)) && outer.second(p);
    };
    constexpr int places = 4000;
    ArcLength along(whole.paths.at(0));
    int visible = 0;
    for (int k = 0; k < places; ++k)
      visible += inside(along.at((k + 0.5) / places * along.total()));
    const Curves part = shapes("<circle r='.01'/><clipPath id='c'>" + first.first + second.first +
                               "</clipPath><clipPath id='o'>" + outer.first +
                               "</clipPath><g clip-path='url(#o)'><g "
                               "clip-path='url(#c)'>" +
                               drawn + "</g></g>");
    const double expected = visible * along.total() / places;
    EXPECT_NEAR(length(part) - 0.02 * pi, expected, 8 * along.total() / places + 0.01) << drawn;
    cut += visible > 0 && visible < places;
    for (const Path& path : part.paths) {
      if (&path == &part.paths.front()) continue;
      ArcLength on(path);
      const Point middle = on.at(on.total() / 2);
      EXPECT_TRUE(on.total() < 0.05 || inside(middle)) << drawn;
    }
  }
  EXPECT_GT(cut, test::scaled(120, 12) / 15);
}

// Lines across all the slabs of the index: the work of one line grows with the product of both.
TEST_F(SvgClip, ComplexClipPathsAreRefused) {
  std::string clip = "M0 0", drawn = "M0 0";
  for (int i = 0; i < 12'000; ++i) {
    clip += fmt::format("L{} {}", i % 2 * 100, i % 3 * 40);
    drawn += fmt::format("L{} {}", i % 3 * 50, i % 2 * 80);
  }
  EXPECT_THAT(error("<clipPath id='c'><path d='" + clip +
                    "'/></clipPath><path clip-path='url(#c)' d='" + drawn + "'/>"),
              HasSubstr("too complex"));
}

TEST_F(SvgClip, DashesAreParts) {
  const auto dashed = [&](const std::string& style, const std::string& d = "M10 40H50") {
    return shapes("<path fill='none' stroke='red' d='" + d + "' style='" + style + "'/>");
  };
  const Curves ten = dashed("stroke-dasharray:3 1");
  ASSERT_EQ(ten.paths.size(), 10u);
  for (std::size_t i = 0; i < 10; ++i) {
    const double x = 10 + 4.0 * static_cast<double>(i);
    EXPECT_NEAR(model::start_of(ten.paths[i]).x, x, 1e-6);
    EXPECT_NEAR(model::end_of(ten.paths[i]).x, x + 3, 1e-6);
  }
  EXPECT_NEAR(length(dashed("stroke-dasharray:5")), 20, 1e-6);
  EXPECT_NEAR(length(dashed("stroke-dasharray:1,2,3")), 20, 1e-6);  // 1 2 3 1 2 3: half of 12
  const Curves shifted = dashed("stroke-dasharray:3 1;stroke-dashoffset:2");
  EXPECT_NEAR(model::end_of(shifted.paths.at(0)).x, 11, 1e-6);
  EXPECT_NEAR(model::start_of(shifted.paths.at(1)).x, 12, 1e-6);
  const Curves back = dashed("stroke-dasharray:3 1;stroke-dashoffset:-1");
  EXPECT_NEAR(model::start_of(back.paths.at(0)).x, 11, 1e-6);
  for (const std::string solid : {"none", "0", "0 0", "-1 2", "x"})
    EXPECT_EQ(dashed("stroke-dasharray:" + solid).paths.size(), 1u) << solid;
  EXPECT_EQ(dashed("stroke-dasharray:0 4;stroke-linecap:round", "M0 0H41").paths.size(), 11u);
  EXPECT_THAT(error("<path fill='none' stroke='red' stroke-dasharray='0 4' d='M0 0H41'/>"),
              HasSubstr("empty"));
  EXPECT_NEAR(length("<path fill='none' stroke='red' pathLength='4' stroke-dasharray='1' "
                     "d='M0 0H50'/>"),
              25, 1e-6);
  // Across corners, over arcs and Bezier curves; on each subpath from its start.
  EXPECT_NEAR(length(dashed("stroke-dasharray:7 3", "M0 0H12V12H0")), 7 * 3 + 6, 1e-6);
  EXPECT_NEAR(length("<circle r='10' cx='50' cy='40' fill='none' stroke='red' "
                     "stroke-dasharray='5 5' pathLength='100'/>"),
              10 * pi, 1e-6);
  EXPECT_EQ(dashed("stroke-dasharray:2 1", "M0 0H3M0 9H3").paths.size(), 2u);
  // Lengths are the user's, also where the map turns and stretches.
  EXPECT_NEAR(length("<g transform='rotate(30) scale(2)' fill='none' stroke='red' "
                     "stroke-dasharray='3 1'><line x2='16'/></g>"),
              24, 1e-6);
  EXPECT_EQ(shapes("<g transform='scale(4 1)'><path fill='none' stroke='red' stroke-dasharray='1' "
                   "d='M0 0H6V6'/></g>")
                .paths.size(),
            6u);
  // A coloured area has its whole edge; without a stroke there are no dashes.
  EXPECT_EQ(shapes("<rect width='9' height='9' fill='red' stroke='blue' stroke-dasharray='1'/>")
                .paths.size(),
            1u);
  EXPECT_EQ(shapes("<rect width='9' height='9' stroke-dasharray='1'/>").paths.size(), 1u);
  EXPECT_EQ(shapes("<rect width='9' height='9' stroke='red' stroke-dasharray='1'/>").paths.size(),
            18u);
}

// Dashes and the gaps of the opposite pattern are the whole curve.
TEST_F(SvgClip, DashesAndGapsAreTheWhole) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> x(5, 95), y(5, 75), part(0.3, 9);
  for (int i = 0; i < test::scaled(60, 6); ++i) {
    const std::string d =
        fmt::format("M{} {}C{} {} {} {} {} {}A9 5 20 0 1 {} {}L{} {}", x(random), y(random),
                    x(random), y(random), x(random), y(random), x(random), y(random), x(random),
                    y(random), x(random), y(random));
    const double dash = part(random), gap = part(random);
    const auto with = [&](double offset, double first, double second) {
      return length(
          fmt::format("<path d='{}' fill='none' stroke='red' stroke-dasharray='{} {}' "
                      "stroke-dashoffset='{}'/>",
                      d, first, second, offset));
    };
    const double whole = length("<path fill='none' stroke='red' d='" + d + "'/>");
    EXPECT_NEAR(with(0, dash, gap) + with(gap, gap, dash), whole, 1e-5 * whole) << d;
  }
}

TEST_F(SvgClip, TooManyDashesAreRefused) {
  EXPECT_THAT(error("<line x2='90' fill='none' stroke='red' stroke-dasharray='1e-9'/>"),
              HasSubstr("more than 2000000 dashes"));
  std::string pattern;
  for (int i = 0; i < 20'000; ++i) pattern += "1 ";
  std::string d;
  for (int i = 0; i < 2'000; ++i) d += "M0 0H1";
  EXPECT_THAT(error("<path stroke='red' stroke-dasharray='" + pattern + "' d='" + d + "'/>"),
              HasSubstr("dashes"));
}

}  // namespace
}  // namespace lamplock::svg_clip_test
