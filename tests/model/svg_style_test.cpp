// What of an SVG is visible: style sheets, properties, encodings, relative units, nested views.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <string_view>

#include "host/model/css.hpp"
#include "tests/model/damaged_drawing.hpp"
#include "tests/model/svg_page.hpp"

namespace lamplock::svg_style_test {
namespace {

using model::Curves;
using std::numbers::pi;
using test::svg_page;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;
using ::testing::StartsWith;

class SvgStyle : public test::SvgPage {
 protected:
  /// True if a square with these attributes is drawn beside another one.
  bool is_drawn(const std::string& attributes, const std::string& before = "") {
    const Curves curves = shapes(before + "<rect " + attributes +
                                 " width='9' height='9'/><rect id='other' width='1' height='1'/>");
    EXPECT_GE(curves.paths.size(), 1u);
    return curves.paths.size() == 2;
  }
  bool is_drawn_by(const std::string& sheet, const std::string& attributes = "class='a b'") {
    return is_drawn(attributes, "<style>" + sheet + "</style>");
  }
};

TEST_F(SvgStyle, InvisibleByAnyPropertyIsNotDrawn) {
  for (const std::string hiding :
       {"display:none", "visibility:hidden", "visibility:collapse", "opacity:0", "opacity:0%",
        "opacity:.0", "fill:none", "fill:transparent", "fill-opacity:0", "fill:#ff000000",
        "fill:#f000", "fill:rgba(1,2,3,0)", "fill:rgb(1 2 3 / 0%)", "fill:none;stroke:none",
        "fill:none;stroke:black;stroke-width:0", "fill:none;stroke:red;stroke-opacity:0",
        "fill:url(#missing)", "fill:url(#missing) none", "transform:scale(0)"}) {
    EXPECT_FALSE(is_drawn("style='" + hiding + "'")) << hiding;
    EXPECT_FALSE(is_drawn_by(".a {" + hiding + "}")) << hiding;
    EXPECT_FALSE(is_drawn_by("rect.a.b\n{\n" + hiding + " !important ;}",
                             "style='opacity:1' "
                             "class='b a'"))
        << hiding;
  }
  for (const std::string showing :
       {"display:inline", "visibility:visible", "opacity:0.1", "fill:red", "fill:none;stroke:red",
        "fill-opacity:0;stroke:#123", "fill:#f001", "fill:rgba(1,2,3,.5)", "fill:url(#other)",
        "fill:url(#missing) red", "fill:none;stroke:red;stroke-width:1px"}) {
    EXPECT_TRUE(is_drawn("style='" + showing + "'")) << showing;
    EXPECT_TRUE(is_drawn_by(".a{" + showing + "}")) << showing;
  }
  const Curves hidden = shapes(
      "<rect width='1' height='1'/><g visibility='hidden'><circle r='1'/></g>"
      "<g opacity='0'><circle r='1'/><circle r='2'/></g>");
  EXPECT_THAT(hidden.left_out, ElementsAre(Pair("hidden", 2u)));
}

TEST_F(SvgStyle, VisibilityAndPaintAreInherited) {
  EXPECT_NEAR(length("<g visibility='hidden'><rect width='3' height='3'/><g visibility='visible'>"
                     "<rect width='1' height='1'/></g></g>"),
              4, 1e-9);
  EXPECT_NEAR(length("<g fill='none'><rect width='3' height='3'/>"
                     "<rect width='1' height='1' stroke='red'/></g>"),
              4, 1e-9);
  EXPECT_NEAR(length("<g style='fill:none;stroke:none'><rect width='3' height='3'/>"
                     "<rect width='1' height='1' style='fill:blue'/></g>"),
              4, 1e-9);
  EXPECT_NEAR(length("<g style='visibility:hidden'><use href='#r' visibility='visible'/></g>"
                     "<defs><rect id='r' width='1' height='1'/></defs>"),
              4, 1e-9);
  EXPECT_NEAR(length("<g fill='none'><g fill='red'><rect fill='inherit' width='1' height='1'/>"
                     "<rect style='fill:none' width='3' height='3'/></g></g>"),
              4, 1e-9);
}

TEST_F(SvgStyle, SelectorsChooseElements) {
  const std::string hide = "{display:none}";
  for (const std::string selector :
       {"rect", "svg *", ".a", ".b", "#i", "rect.a", "rect#i.a.b", ".x,.a", "svg rect", "svg>rect",
        "svg > .a", "* .a", ":root .b", "[id]", "[id=i]", "rect[class='a b']", "[id=\"i\"]",
        "/* c */ .a /* d */"}) {
    EXPECT_FALSE(is_drawn_by(selector + hide + "#other{display:inline}", "class='a b' id='i'"))
        << selector;
  }
  for (const std::string selector :
       {"circle", ".c", ".ab", "#a", "circle.a", "rect.a.c", "g rect", "g>rect", "rect rect",
        "rect:hover", "[id=a]", "[width='8']", "@media print{rect", ".A"}) {
    EXPECT_TRUE(is_drawn_by(selector + hide, "class='a b' id='i'")) << selector;
  }
  const std::string nested =
      "<g class='p'><g><rect class='a' width='1' height='1'/></g></g>"
      "<circle r='1'/>";
  EXPECT_EQ(shapes("<style>.p .a{display:none}</style>" + nested).paths.size(), 1u);
  EXPECT_EQ(shapes("<style>.p > .a{display:none}</style>" + nested).paths.size(), 2u);
  EXPECT_EQ(shapes("<style>.p > g > .a{display:none}</style>" + nested).paths.size(), 1u);
}

TEST_F(SvgStyle, TheCascadeHasItsOrder) {
  // Later rules, more specific ones, the style attribute, !important; the attribute is the weakest.
  EXPECT_FALSE(is_drawn_by(".a{display:inline}.b{display:none}"));
  EXPECT_TRUE(is_drawn_by(".a{display:none}.b{display:inline}"));
  EXPECT_FALSE(is_drawn_by("rect.a{display:none}.b{display:inline}"));
  EXPECT_FALSE(is_drawn_by("#i{display:none}.a.b{display:inline}", "id='i' class='a b'"));
  EXPECT_TRUE(is_drawn_by(".a{display:none}", "class='a' style='display:inline'"));
  EXPECT_FALSE(is_drawn_by(".a{display:none!important}", "class='a' style='display:inline'"));
  EXPECT_TRUE(
      is_drawn_by(".a{display:none!important}", "class='a' style='display:inline ! important'"));
  EXPECT_FALSE(is_drawn_by(".a{display:none}", "class='a' display='inline'"));
  EXPECT_FALSE(is_drawn_by(".a{display:none !important}.b{display:inline}"));
  EXPECT_FALSE(is_drawn("style='display:inline' class='a'",
                        "<style><![CDATA[ .a > .b, .a { display : none ! IMPORTANT } ]]></style>"));
}

TEST_F(SvgStyle, StyleSheetsGiveGeometry) {
  EXPECT_NEAR(length("<style>.t{transform:translate(20px,0) scale(2)}</style>"
                     "<circle class='t' r='1'/>"),
              4 * pi, 1e-8);
  const auto box =
      model::bounds(shapes("<circle style='transform:translate(20px,1cm) "
                           "rotate(0.25turn)' cx='10' cy='0' r='5'/>"));
  EXPECT_NEAR(box.low.x, 15, 1e-3);
  EXPECT_NEAR(box.high.y, 80 - 10 * 96 / 25.4 - 10 + 5, 1e-3);
  EXPECT_NEAR(length("<style>circle{r:2px;cx:9px}</style><circle r='9'/>"), 4 * pi, 1e-8);
  EXPECT_NEAR(length("<path style='d:path(\"M0 0H7\")'/>"), 7, 1e-9);
  const auto turned = model::bounds(
      shapes("<rect width='10' height='4' style='transform-origin:10px 4px;rotate:180deg'/>"));
  EXPECT_NEAR(turned.low.x, 10, 1e-9);
  EXPECT_NEAR(turned.low.y, 80 - 8, 1e-9);
}

TEST_F(SvgStyle, UnreadRulesAreCounted) {
  const Curves curves = shapes(
      "<style>@import 'x.css'; @font-face{a:b} a+b{display:none} rect:nth-child(2){fill:none} "
      "rect:hover{fill:none} @media print{rect{display:none}} {} rect</style>"
      "<rect width='1' height='1'/>");
  EXPECT_EQ(curves.paths.size(), 1u);
  EXPECT_THAT(curves.left_out,
              ElementsAre(Pair("rule of a style sheet, first '@import 'x.css''", 5u)));
  const std::string rect = "<rect class='x' width='1' height='1'/>";
  for (const char* const rule :
       {"@supports (display:grid){.x{display:none}}", "@layer a{.x{display:none}}",
        "@container (width>1px){.x{display:none}}", "@scope (.x){.x{display:none}}",
        "g{.x{display:none}}", "g{fill:red;&:hover{fill:none}}", "@MEDIA print{.x{fill:none}}"}) {
    const Curves one = shapes("<style>" + std::string(rule) + "</style><g>" + rect + "</g>");
    EXPECT_EQ(one.paths.size(), 1u) << rule;
    EXPECT_THAT(one.left_out, ElementsAre(Pair(StartsWith("rule of a style sheet"), 1u))) << rule;
  }
  // The declarations round a nested rule are read, a rule that hides nothing by itself is not
  // counted.
  EXPECT_FALSE(is_drawn("class='a'", "<style>.a{fill:red;b{fill:blue} display:none}</style>"));
  EXPECT_THAT(shapes("<style>@layer a,b; @keyframes k{to{fill:none}} @Media screen{.x{fill:red}}"
                     "</style>" +
                     rect)
                  .left_out,
              IsEmpty());
}

TEST_F(SvgStyle, VariablesHaveTheirValues) {
  EXPECT_FALSE(is_drawn("style='fill:var(--c)'", "<style>:root{--c:none}</style>"));
  EXPECT_FALSE(is_drawn("fill='var(--c, none)' stroke='none'"));
  EXPECT_FALSE(is_drawn("style='--a:var(--b);--b:none;fill:var(--a)'"));
  EXPECT_FALSE(is_drawn("style='fill:var(--x, var( --y , NONE))'"));
  EXPECT_TRUE(is_drawn("style='fill:VAR(--c)'", "<style>:root{--c:none} rect{--c:red}</style>"));
  // Names have their case. A variable without a value leaves the property unset.
  EXPECT_TRUE(is_drawn("style='fill:var(--C)'", "<style>:root{--c:none}</style>"));
  EXPECT_TRUE(is_drawn("style='--a:var(--b);--b:var(--a);fill:var(--a)'"));
  EXPECT_NEAR(length("<g style='--s:2'><circle style='--r:calc;r:var(--s)' r='9'/></g>"), 4 * pi,
              1e-8);
  // The strongest declaration of a variable wins.
  EXPECT_FALSE(
      is_drawn("class='a' style='--c:red;fill:var(--c)'", "<style>.a{--c:none!important}</style>"));
}

TEST_F(SvgStyle, VariablesThatDoubleEachOtherEnd) {
  std::string doubling = "--v0:none none none none;";
  for (int i = 1; i <= 60; ++i)
    doubling += fmt::format("--v{0}:var(--v{1}) var(--v{1});", i, i - 1);
  EXPECT_TRUE(is_drawn("style='" + doubling + "fill:var(--v60)'"));
  // Values of 4096 words, for 20 000 elements.
  std::string elements;
  for (int i = 0; i < 20'000; ++i) elements += "<rect class='k'/>";
  EXPECT_THAT(error("<style>:root{" + doubling + "} .k{fill:var(--v10);stroke:var(--v10)}</style>" +
                    elements),
              HasSubstr("too many rules"));
}

TEST_F(SvgStyle, KeywordsIgnoreCase) {
  for (const char* const attributes :
       {"style='display:NONE'", "display='None'", "style='VISIBILITY:Hidden'",
        "style='fill:Transparent;stroke:NONE'", "fill='NONE' stroke='None'",
        "style='fill:RGBA(0,0,0,0)'"})
    EXPECT_FALSE(is_drawn(attributes)) << attributes;
  EXPECT_TRUE(is_drawn("display='Inline' fill='RED'"));
  // Names of elements keep their case.
  EXPECT_FALSE(is_drawn("clip-path='URL(#Cut)'",
                        "<clipPath id='Cut'><rect x='50' width='1' height='1'/></clipPath>"));
}

TEST_F(SvgStyle, DrawingsWithTooManyRulesAreRefused) {
  std::string rules, elements;
  for (int i = 0; i < 6000; ++i) rules += "g g rect{fill:red}";
  for (int i = 0; i < 6000; ++i) elements += "<rect width='1' height='1'/>";
  EXPECT_THAT(error("<style>" + rules + "</style>" + elements), HasSubstr("too many rules"));
}

TEST_F(SvgStyle, RelativeUnits) {
  const auto line = [&](const std::string& size, const std::string& around = "<g>") {
    return length(around + "<line x2='" + size + "'/></g>");
  };
  EXPECT_NEAR(line("2em"), 32, 1e-9);
  EXPECT_NEAR(line("2ex"), 16, 1e-9);
  EXPECT_NEAR(line("1rem"), 16, 1e-9);
  EXPECT_NEAR(line("2em", "<g font-size='5'>"), 10, 1e-9);
  EXPECT_NEAR(line("2em", "<g style='font-size:2em'>"), 64, 1e-9);
  EXPECT_NEAR(line("2rem", "<g style='font-size:3px'>"), 32, 1e-9);
  EXPECT_NEAR(line("1em", "<g font-size='50%'>"), 8, 1e-9);
  EXPECT_NEAR(line("1em", "<g font-size='large'>"), 18, 1e-9);
  EXPECT_NEAR(line("10vw"), 10 * 96 / 25.4, 1e-9);  // user's units, not mm
  EXPECT_NEAR(line("10VH"), 8 * 96 / 25.4, 1e-9);
  EXPECT_NEAR(line("50%"), 50, 1e-9);
  const Curves root = read(
      "<svg font-size='10' width='10em' height='5em' viewBox='0 0 100 50'>"
      "<line x2='1rem'/></svg>");
  EXPECT_NEAR(length(root), 10 * 25.4 / 96, 1e-9);
  EXPECT_NEAR(
      length(read("<svg style='width:100%' width='50mm' height='50mm'><line x2='50%'/></svg>")), 25,
      1e-9);
}

std::string in_utf16(const std::string& text, bool big_endian, bool has_mark) {
  std::string bytes;
  const auto append = [&](unsigned unit) {
    const char low = static_cast<char>(unit & 0xFFU), high = static_cast<char>(unit >> 8U);
    bytes += big_endian ? high : low;
    bytes += big_endian ? low : high;
  };
  if (has_mark) append(0xFEFF);
  for (const char c : text) append(static_cast<unsigned char>(c));  // Latin-1
  return bytes;
}

TEST_F(SvgStyle, EncodingsAreRead) {
  const std::string text = svg_page("<g id='caf\xE9'><rect width='1' height='2'/>\n</g>");
  for (const bool big_endian : {false, true}) {
    for (const bool has_mark : {false, true}) {
      const Curves curves = read(in_utf16(text, big_endian, has_mark));
      EXPECT_NEAR(length(curves), 6, 1e-9);
      EXPECT_THAT(curves.layers, ElementsAre("caf\xC3\xA9"));
    }
  }
  std::string latin = text;
  latin.insert(latin.find("?>"), " encoding='ISO-8859-1'");
  EXPECT_THAT(read(latin).layers, ElementsAre("caf\xC3\xA9"));
  EXPECT_NEAR(length(read("\xEF\xBB\xBF" + svg_page("<rect width='1' height='2'/>"))), 6, 1e-9);
  // Errors count the lines of the text.
  const auto path = folder_.write("b.svg", in_utf16(svg_page("\n<circle r='-1'/>"), false, true));
  EXPECT_THAT(test::error_of([&] { model::read_svg(path); }), HasSubstr("line 4: the radii"));
  const auto cut = folder_.write("c.svg", in_utf16(svg_page("<g>"), true, true).substr(0, 77));
  EXPECT_THAT(test::error_of([&] { model::read_svg(cut); }), HasSubstr("not valid XML"));
}

TEST_F(SvgStyle, BackgroundsAreLeftOut) {
  const std::string white = "<rect width='100' height='80' fill='white'/>";
  const Curves curves = shapes(white + "<circle cx='50' cy='40' r='5'/>");
  EXPECT_NEAR(length(curves), 10 * pi, 1e-8);
  EXPECT_THAT(curves.left_out, ElementsAre(Pair("background of the page", 1u)));
  EXPECT_NEAR(length(white), 360, 1e-9);  // the whole drawing
  for (const std::string area :
       {"<polygon points='-1,81 -1,-1 101,-1 101,81 -1,81' fill='white' stroke='transparent'/>",
        "<path d='M0 0h100v80H0z' style='fill:#EEE'/>"})
    EXPECT_EQ(shapes(area + "<circle cx='50' cy='40' r='5'/>").paths.size(), 1u) << area;
  for (const std::string frame :
       {"<rect width='100' height='80' fill='white' stroke='black'/>",
        "<rect width='100' height='80' fill='none' stroke='black'/>",
        "<path d='M0 0H100L50 80Z' fill='red'/>", "<rect width='99' height='80' fill='white'/>",
        "<rect width='100' height='80'/>"})
    EXPECT_EQ(shapes(frame + "<circle cx='50' cy='40' r='5'/>").paths.size(), 2u) << frame;
  EXPECT_EQ(shapes("<circle cx='50' cy='40' r='5'/>" + white).paths.size(), 2u);
}

TEST_F(SvgStyle, NestedViewsHideWhatLeavesThem) {
  const std::string line = "<line x1='-5' x2='20' y1='1' y2='1'/></svg>";
  EXPECT_NEAR(length("<svg x='10' width='10' height='10'>" + line), 10, 1e-6);
  EXPECT_NEAR(length("<svg width='10' height='10' overflow='visible'>" + line), 25, 1e-9);
  EXPECT_NEAR(length("<svg width='10' height='10' style='overflow:visible'>" + line), 25, 1e-9);
  EXPECT_NEAR(length("<svg width='10' height='5' viewBox='0 0 20 20' "
                     "preserveAspectRatio='xMidYMid slice'><line x2='30' y1='10' y2='10'/></svg>"),
              10, 1e-6);
  EXPECT_NEAR(length("<symbol id='s' viewBox='0 0 4 4'><line x2='9' y1='2' y2='2'/></symbol>"
                     "<use href='#s' width='8' height='8'/>"),
              8, 1e-6);
  EXPECT_THAT(error("<svg width='0' height='5'><line x2='3'/></svg>"), HasSubstr("1 hidden"));
  EXPECT_THAT(error("<symbol id='s' opacity='0'><line x2='9'/></symbol><use href='#s'/>"),
              HasSubstr("1 hidden"));
}

TEST_F(SvgStyle, SwitchesDrawOneElement) {
  EXPECT_NEAR(length("<switch><foreignObject requiredExtensions='x'/><g><line x2='3'/></g>"
                     "<line x2='9'/></switch>"),
              3, 1e-9);
  EXPECT_NEAR(length("<switch><line x2='9' systemLanguage='xx'/><line x2='4' "
                     "systemLanguage='de,en-GB'/><line x2='8'/></switch>"),
              4, 1e-9);
}

TEST_F(SvgStyle, DamagedFilesAtWorstFail) {
  const std::string whole = svg_page(
      "<style>.a > .b, #r:root, g [x='1'] { fill : none !important; stroke: rgba(1,2,3,.5) } "
      "@media all { rect { clip-path : url(#c) ; stroke-dasharray: 2px, 1 3% } } </style>"
      "<clipPath id='c' clipPathUnits='objectBoundingBox'><circle cx='.5' cy='.5' r='.4'/>"
      "</clipPath><mask id='m'><path d='M0 0H50V50Z' fill='white'/></mask>"
      "<g class='a' font-size='2em' mask='url(#m)'><path class='b' "
      "d='M1 2L3 4C1 2 3 4 5 6A3 4 30 0 1 9 9Z' stroke-dasharray='1 .5' pathLength='20'/></g>"
      "<rect id='r' x='1em' width='30' height='20' rx='3'/><use href='#r' x='5' "
      "clip-path='url(#c)'/>"
      "<svg x='3' width='20%' height='9vh' viewBox='0 0 9 9'><ellipse cx='5' cy='5' "
      "rx='5'/></svg>");
  ASSERT_GE(read(whole).paths.size(), 5u);
  const auto read_file = [](const auto& path) { return model::read_svg(path); };
  test::expect_damaged_drawings_fail_at_most(
      folder_, "a.svg", whole, "0123456789.-+eE <>/='\"#MLCZ{}():;,%!*\n\xFF", read_file);
  test::expect_damaged_drawings_fail_at_most(folder_, "a.svg", in_utf16(whole, false, true),
                                             test::any_byte(), read_file);
}

}  // namespace
}  // namespace lamplock::svg_style_test
