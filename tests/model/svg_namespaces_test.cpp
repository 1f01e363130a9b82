// Namespaces, media, filters and boxes of SVG files: what is an element of the drawing, and where.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "host/geometry/bounds.hpp"
#include "host/model/css.hpp"
#include "tests/model/svg_page.hpp"

namespace lamplock::svg_namespaces_test {
namespace {

using model::Curves;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;
using ::testing::StartsWith;

class SvgNamespaces : public test::SvgPage {
 protected:
  geometry::Bounds box(const std::string& content) { return model::bounds(shapes(content)); }
};

TEST_F(SvgNamespaces, APrefixOfAllElementsIsRead) {
  const Curves curves = read(
      "<s:svg xmlns:s='http://www.w3.org/2000/svg' xmlns:x='http://www.w3.org/1999/xlink' "
      "xmlns:ink='http://www.inkscape.org/namespaces/inkscape' width='9' height='9'>"
      "<s:style>rect{display:none}</s:style><s:rect width='3' height='3'/><rect width='2' "
      "height='2'/><s:g ink:groupmode='layer' ink:label='L'><s:circle id='c' r='1'/></s:g>"
      "<s:use x:href='#c'/></s:svg>");
  EXPECT_EQ(curves.paths.size(), 2u);
  EXPECT_THAT(curves.layers, ElementsAre("L", ""));
  EXPECT_THAT(curves.left_out,
              ElementsAre(Pair("element of another namespace", 1u), Pair("hidden", 1u)));
}

TEST_F(SvgNamespaces, ElementsOfOtherNamespacesAreNotDrawn) {
  const Curves curves = shapes(
      "<g xmlns='http://foo'><rect width='5' height='5'/></g><g xmlns:f='http://foo'><f:rect "
      "width='5' height='5'/><f:data/></g><f:rect xmlns:f='http://www.w3.org/2000/svg' width='1' "
      "height='1'/><foreignObject><p xmlns='http://www.w3.org/1999/xhtml'/></foreignObject>"
      "<metadata><rdf xmlns='http://r'/></metadata>");
  EXPECT_EQ(curves.paths.size(), 1u);
  EXPECT_THAT(curves.left_out,
              ElementsAre(Pair("element of another namespace", 2u), Pair("foreignObject", 1u)));
  EXPECT_THAT(read("<svg width='9' height='9'><circle r='1'/></svg>").left_out, IsEmpty());
  const auto path = folder_.write("b.svg", "<svg xmlns='http://foo'><circle r='1'/></svg>");
  EXPECT_THAT(test::error_of([&] { model::read_svg(path); }), HasSubstr("namespace 'http://foo'"));
}

TEST_F(SvgNamespaces, StyleSheetsForOtherMediaAreNotRead) {
  for (const std::string media : {"", "all", "screen", " Screen ", "print, screen", "only screen",
                                  "not print", "speech,all"}) {
    EXPECT_TRUE(model::is_for_screens(media)) << media;
    EXPECT_THAT(shapes("<style media='" + media + "'>.a{display:none}@media " +
                       (media.empty() ? "all" : media) +
                       "{.b{display:none}}</style><rect class='a' width='1' height='1'/>"
                       "<rect class='b' width='1' height='1'/><circle r='1'/>")
                    .left_out,
                ElementsAre(Pair("hidden", 2u)))
        << media;
  }
  for (const std::string media : {"print", "speech, print", "not all", "only print", "not screen",
                                  "(min-width: 1px)", "screen and (min-width: 1px)", ","}) {
    const Curves curves = shapes("<style media='" + media +
                                 "'>.a{display:none}</style><rect class='a' width='1' "
                                 "height='1'/>");
    EXPECT_EQ(curves.paths.size(), 1u) << media;
    EXPECT_THAT(curves.left_out,
                ElementsAre(Pair(StartsWith("rule of a style sheet, first '"), 1u)))
        << media;
  }
}

TEST_F(SvgNamespaces, SingleTransformsAreAppliedAndFiltersCounted) {
  const auto moved = box("<rect width='4' height='2' style='translate:10px 20px;scale:2 3'/>");
  EXPECT_NEAR(moved.low.x, 10, 1e-9);
  EXPECT_NEAR(moved.high.x, 18, 1e-9);
  EXPECT_NEAR(moved.high.y, 60, 1e-9);
  EXPECT_NEAR(moved.low.y, 54, 1e-9);
  // As attributes they belong to other elements.
  EXPECT_NEAR(box("<rect width='4' height='2' scale='5' rotate='45'/>").high.x, 4, 1e-9);
  EXPECT_THAT(
      shapes("<g style='filter:blur(2px)'><rect width='1' height='1' filter='none'/></g>").left_out,
      ElementsAre(Pair("filter", 1u)));
}

TEST_F(SvgNamespaces, TransformBoxIsTheBoxOfTheElement) {
  const std::string style = "style='transform-box:fill-box;transform-origin:center;scale:.5'";
  for (const std::string& content :
       {"<rect x='20' y='30' width='8' height='4' " + style + "/>",
        "<g " + style +
            "><g transform='translate(20 30)'><rect width='4' height='4'/><rect x='4' "
            "width='4' height='2'/></g></g>"}) {
    const auto scaled = box(content);
    EXPECT_NEAR(scaled.low.x, 22, 1e-9) << content;
    EXPECT_NEAR(scaled.high.x, 26, 1e-9) << content;
    EXPECT_NEAR(scaled.high.y, 80 - 31, 1e-9) << content;
  }
}

TEST_F(SvgNamespaces, ClipPathsByTheBoxOfAGroup) {
  const std::string clip =
      "<clipPath id='c' clipPathUnits='objectBoundingBox'><rect width='.5' height='1'/></clipPath>";
  const Curves curves = shapes(clip +
                               "<g clip-path='url(#c)' transform='translate(10 0)'><line x2='10' "
                               "y1='1' y2='1'/><g transform='translate(10 2)'><line x2='10' y1='5' "
                               "y2='5'/></g></g>");
  EXPECT_NEAR(length(curves), 10, 2e-3);
  EXPECT_NEAR(model::bounds(curves).high.x, 20, 2e-3);
  EXPECT_THAT(curves.left_out, ElementsAre(Pair("clipped curve", 1u)));
  // The box of a text is not known.
  EXPECT_THAT(
      shapes(clip + "<g clip-path='url(#c)'><text>a</text><line x2='9'/></g><circle r='1'/>")
          .left_out,
      ElementsAre(Pair("element with a clip path or mask that cannot be applied", 1u)));
  // Groups in groups are measured once each.
  std::string deep = "<circle r='1'/>";
  for (int i = 0; i < 60; ++i)
    deep = fmt::format("<g style='transform-box:fill-box;transform-origin:center;scale:.99'>{}</g>",
                       deep);
  EXPECT_NEAR(length(deep), 2 * std::numbers::pi * std::pow(0.99, 60), 1e-6);
}

}  // namespace
}  // namespace lamplock::svg_namespaces_test
