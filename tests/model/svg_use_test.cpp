// Elements of an SVG that are used elsewhere: their places, sizes, clip paths and masks.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "tests/model/svg_page.hpp"
#include "tests/scale.hpp"

namespace lamplock::svg_use_test {
namespace {

using geometry::Bounds;
using model::Curves;

class SvgUse : public test::SvgPage {
 protected:
  static void expect_equal(const Curves& one, const Curves& other, const std::string& what) {
    ASSERT_EQ(one.paths.size(), other.paths.size()) << what;
    const Bounds a = model::bounds(one), b = model::bounds(other);
    constexpr double rounding = 5e-3;  // of clipped ends
    EXPECT_NEAR(length(one), length(other), rounding) << what;
    EXPECT_NEAR(a.low.x, b.low.x, rounding) << what;
    EXPECT_NEAR(a.low.y, b.low.y, rounding) << what;
    EXPECT_NEAR(a.high.x, b.high.x, rounding) << what;
    EXPECT_NEAR(a.high.y, b.high.y, rounding) << what;
  }
};

// x and y are a translation after the transform, also for what clips the use.
TEST_F(SvgUse, XAndYMoveItsClipPathAndMask) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> place(0, 20), angle(-40, 40);
  const std::string content =
      "<defs><g id='t'><path d='M0 10H40M0 14H40' fill='none' stroke='red'/></g>"
      "<clipPath id='c'><circle cx='12' cy='10' r='8'/></clipPath>"
      "<clipPath id='b' clipPathUnits='objectBoundingBox'><rect x='.2' y='-1' width='.5' "
      "height='3'/></clipPath>"
      "<mask id='m' maskUnits='userSpaceOnUse' x='2' y='0' width='20' height='20'>"
      "<circle cx='12' cy='10' r='8' fill='white'/></mask>"
      "<clipPath id='n'><use href='#k' x='3' y='1' clip-path='url(#c)'/></clipPath>"
      "<rect id='k' width='30' height='30'/></defs>";
  for (const std::string how :
       {"clip-path='url(#c)'", "mask='url(#m)'", "clip-path='url(#b)'", "clip-path='url(#n)'",
        "style='clip-path:url(#c)' mask='url(#m)'"}) {
    for (int i = 0; i < test::scaled(6, 2); ++i) {
      const double x = place(random), y = place(random), turn = angle(random);
      const std::string moved =
          fmt::format("<use href='#t' {} transform='translate(20 20) rotate({})' x='{}' y='{}'/>",
                      how, turn, x, y);
      const std::string plain = fmt::format(
          "<use href='#t' {} transform='translate(20 20) rotate({}) translate({} {})'/>", how, turn,
          x, y);
      expect_equal(shapes(content + moved), shapes(content + plain), moved);
    }
  }
}

// The clip path of a use in a clip path is that of its user space, which x and y have moved.
TEST_F(SvgUse, XAndYMoveTheClipPathOfAUseInAClipPath) {
  const std::string line = "<line y1='40' x2='100' y2='40'/>";
  EXPECT_NEAR(length("<clipPath id='a'><rect width='10' height='80'/></clipPath>"
                     "<clipPath id='c'><use href='#r' x='30' clip-path='url(#a)'/></clipPath>"
                     "<defs><rect id='r' x='5' width='40' height='80'/></defs>"
                     "<g clip-path='url(#c)'>" +
                     line + "</g><circle r='0'/>"),
              5, 1e-6);
}

// A size of the use replaces that of the svg; a missing one does not.
TEST_F(SvgUse, SizesOfAUseReplaceThoseOfTheElement) {
  const auto length_of = [&](const std::string& element, const std::string& use) {
    return length("<defs>" + element + "</defs><use href='#n' x='10' y='10' " + use + "/>");
  };
  const auto nested = [](const std::string& name, const std::string& sizes) {
    return fmt::format(
        "<{0} id='n' viewBox='0 0 10 10' preserveAspectRatio='none' {1} overflow='visible'>"
        "<rect width='10' height='10'/></{0}>",
        name, sizes);
  };
  for (const std::string name : {"svg", "symbol"}) {
    const std::string sized = nested(name, "width='20' height='10'");
    EXPECT_NEAR(length_of(sized, ""), 60, 1e-6) << name;
    EXPECT_NEAR(length_of(sized, "width='30'"), 80, 1e-6) << name;
    EXPECT_NEAR(length_of(sized, "height='30'"), 100, 1e-6) << name;
    EXPECT_NEAR(length_of(sized, "width='auto' height='30'"), 100, 1e-6) << name;
    EXPECT_NEAR(length_of(sized, "width='50%' height='50%'"), 180, 1e-6) << name;
    // By default 100 % of 100 x 80.
    EXPECT_NEAR(length_of(nested(name, ""), "width='30'"), 220, 1e-6) << name;
    EXPECT_NEAR(length_of(nested(name, "height='10'"), ""), 220, 1e-6) << name;
    EXPECT_NEAR(length_of(nested(name, "width='5'"), "height='10'"), 30, 1e-6) << name;
  }
}

// What a mask uses inherits from the use, its groups and the mask, as elsewhere.
TEST_F(SvgUse, MasksOfUsedShapesClip) {
  const std::string defs =
      "<defs><rect id='r' x='5' width='20' height='80'/><g id='g'><use href='#r'/></g>"
      "<symbol id='s' viewBox='0 0 10 10'><rect x='-5' width='20' height='10'/></symbol>"
      "<svg id='v' width='20' height='80'><rect width='90' height='90'/></svg>"
      "<path id='o' d='M5 0H45V80H5ZM15 0H35V80H15Z'/>"
      "<rect id='b' width='20' height='80' fill='black'/></defs>";
  struct Case {
    std::string mask;
    double length_mm;
  };
  for (const Case& one : std::vector<Case>{
           {"<mask id='m' fill='white'><use href='#r'/></mask>", 20},
           {"<mask id='m'><use href='#r' fill='#fff'/></mask>", 20},
           {"<mask id='m'><use href='#r' style='fill:#ffffff' x='7'/></mask>", 20},
           {"<g fill='white'><mask id='m'><use href='#r'/></mask></g>", 20},
           {"<mask id='m'><g fill='white'><g><use href='#g'/><use href='#g' "
            "x='30'/></g></g></mask>",
            40},
           {"<mask id='m' fill='white'><g transform='scale(2 1)'><use href='#r'/></g></mask>", 40},
           {"<mask id='m' fill='white'><use href='#s' width='30' height='80'/></mask>", 30},
           {"<mask id='m' fill='white'><use href='#v' x='3'/></mask>", 20},
           {"<mask id='m' fill='white'><use href='#v' x='3' width='50'/></mask>", 50},
           {"<mask id='m' fill='white'><svg width='9'><rect width='30' height='80'/></svg></mask>",
            9},
           {"<mask id='m' fill='white'><a><switch><use href='#r'/></switch></a></mask>", 20},
           {"<mask id='m' fill='white'><title>t</title><defs><text/></defs><use href='#r'/></mask>",
            20},
           {"<mask id='m' fill='white' fill-rule='evenodd'><use href='#o'/></mask>", 20},
           {"<mask id='m' fill='white'><use href='#o'/></mask>", 40},
           {"<mask id='m' fill='white'><use href='#r'/><use href='#r' x='40' opacity='0'/></mask>",
            20},
           {"<mask id='m' fill='white'><use href='#r'/><use href='#r' x='40' fill='none'/></mask>",
            20},
           {"<clipPath id='k'><rect width='15' height='80'/></clipPath><mask id='m' fill='white'>"
            "<g clip-path='url(#k)'><use href='#r'/></g></mask>",
            10},
           {"<mask id='m' style='mask-type:alpha'><use href='#r'/></mask>", 20}}) {
    const Curves curves =
        shapes(defs + one.mask + "<g mask='url(#m)'><path d='M0 40H100' stroke='red'/></g>");
    EXPECT_NEAR(length(curves), one.length_mm, 5e-3) << one.mask;
    EXPECT_TRUE(curves.left_out.empty()) << one.mask;
  }
  for (const std::string mask :
       {"<mask id='m'><use href='#r'/></mask>", "<mask id='m' fill='white'><use href='#b'/></mask>",
        "<mask id='m' fill='white'><use href='#r' opacity='.5'/></mask>",
        "<mask id='m' fill='white'><g filter='url(#f)'><use href='#r'/></g></mask>",
        "<mask id='m' fill='white' stroke='white'><use href='#r'/></mask>",
        "<linearGradient id='l'/><mask id='m' style='mask-type:alpha' fill='url(#l)'>"
        "<use href='#r'/></mask>"}) {
    const Curves curves =
        shapes(defs + mask + "<circle r='1'/><g mask='url(#m)'><path d='M0 40H100'/></g>");
    EXPECT_EQ(curves.paths.size(), 1u) << mask;
    EXPECT_EQ(curves.left_out.size(), 1u) << mask;
  }
}

// Each use of a mask is one level: a chain without end is refused.
TEST_F(SvgUse, MasksOfManyLevelsAreRefused) {
  std::string chain = "<rect id='u0' width='9' height='9'/>";
  for (int i = 1; i <= 300; ++i)
    chain += fmt::format("<g id='u{}'><use href='#u{}'/></g>", i, i - 1);
  EXPECT_THAT(error("<defs>" + chain +
                    "</defs><mask id='m' fill='white'><use href='#u300'/></mask>"
                    "<g mask='url(#m)'><path d='M0 4H9'/></g>"),
              ::testing::HasSubstr("nested deeper"));
}

}  // namespace
}  // namespace lamplock::svg_use_test
