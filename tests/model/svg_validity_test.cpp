// Values and selectors of an SVG that are not valid, conditions, references in all their forms.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "host/model/svg_colour.hpp"
#include "tests/model/svg_page.hpp"

namespace lamplock::svg_validity_test {
namespace {

using model::Curves;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;
using ::testing::StartsWith;

class SvgValidity : public test::SvgPage {
 protected:
  /// The number of paths drawn besides one that always is.
  std::size_t count(const std::string& content) {
    return shapes(content + "<circle cx='90' cy='70' r='1'/>").paths.size() - 1;
  }
};

TEST_F(SvgValidity, ColoursHaveManyForms) {
  for (const std::string white :
       {"white", "WHITE", "#fff", "#FFFFFF", "#ffff", "#ffffffff", "rgb(255,255,255)",
        "rgb(255 255 255)", "rgb(100%, 100%, 100%)", "rgba(255,255,255,1)", "hsl(0,0%,100%)",
        "hsl(210 50% 100%)", "hsla(9deg, 3%, 100%, 1)", "HSL(0 0% 100% / 100%)", "hwb(0 100% 0%)",
        "oklab(100% 0 0)", "lab(100 0 0)"}) {
    const auto colour = model::find_svg_colour(white);
    ASSERT_TRUE(colour) << white;
    EXPECT_TRUE(colour->is_white) << white;
  }
  for (const auto& [text, alpha] :
       std::vector<std::pair<std::string, double>>{{"red", 1},
                                                   {"#fffffe", 1},
                                                   {"hsl(0,0%,99%)", 1},
                                                   {"rgba(255,255,255,.5)", 0.5},
                                                   {"#fff0", 0},
                                                   {"#12345600", 0},
                                                   {"transparent", 0},
                                                   {"hsl(0 0% 100% / 25%)", 0.25},
                                                   {"rgb(1 2 3 / none)", 0},
                                                   {"CurrentColor", 1},
                                                   {"color(srgb 1 1 1)", 1}}) {
    const auto colour = model::find_svg_colour(text);
    ASSERT_TRUE(colour) << text;
    EXPECT_FALSE(colour->is_white) << text;
    EXPECT_NEAR(colour->alpha, alpha, 1e-12) << text;
  }
  for (const std::string text :
       {"", "bogus", "#ff", "#fffff", "#ggg", "fff", "rgb(1,2)", "rgb(1,2,3,4,5)", "rgb(a,b,c)",
        "hsl 1 2 3", "blue2", "d b", "rgb(", "rgb(1,2,3", "blurb(1,2,3)"})
    EXPECT_FALSE(model::find_svg_colour(text)) << text;
}

// A white fill, by any form of its colour, does not hide the dashes of a stroke.
TEST_F(SvgValidity, WhiteFillsInAnyFormAreThePage) {
  for (const std::string white : {"white", "hsl(0,0%,100%)", "rgb(255 255 255 / 1)", "#ffff"})
    EXPECT_NEAR(length(fmt::format("<rect width='20' height='20' fill='{}' stroke='red' "
                                   "stroke-dasharray='2 2'/>",
                                   white)),
                40, 1e-6)
        << white;
}

// An invalid value is as none: the property is inherited, or has its initial value.
TEST_F(SvgValidity, InvalidValuesAreIgnored) {
  const auto line = [](const std::string& attributes) {
    return "<path d='M0 5H20' fill='none' " + attributes + "/>";
  };
  const auto in_group = [](const std::string& attributes, const std::string& content) {
    return "<g " + attributes + ">" + content + "</g>";
  };
  for (const std::string bad : {"stroke='bogus'", "style='stroke:bogus'", "stroke='#12'",
                                "stroke='rgb(1,2)'", "stroke='url(#x) bogus'"}) {
    EXPECT_EQ(count(line(bad)), 0u) << bad;
    EXPECT_EQ(count(in_group("stroke='red'", line(bad))), 1u) << bad;
  }
  // A weaker valid declaration applies.
  EXPECT_EQ(count(line("stroke='red' style='stroke:bogus'")), 1u);
  EXPECT_EQ(count(line("style='stroke:red;stroke:bogus'")), 1u);
  EXPECT_EQ(count("<style>.a{stroke:none} .a{stroke:12px}</style>" +
                  in_group("stroke='red'", line("class='a'"))),
            0u);
  EXPECT_EQ(count("<rect width='5' height='5' fill='bogus'/>"), 1u);
  EXPECT_EQ(count(in_group("fill='none'", "<rect width='5' height='5' fill='bogus'/>")), 0u);
  for (const std::string bad :
       {"stroke-width='-1'", "style='stroke-width:-2px'", "stroke-width='bogus'"}) {
    EXPECT_EQ(count(line("stroke='red' " + bad)), 1u) << bad;
    EXPECT_EQ(count(in_group("stroke-width='0'", line("stroke='red' " + bad))), 0u) << bad;
  }
  for (const std::string bad : {"stroke-dasharray='-1 2'", "stroke-dasharray='1 x'"}) {
    EXPECT_EQ(count(line("stroke='red' " + bad)), 1u) << bad;
    EXPECT_EQ(count(in_group("stroke-dasharray='5'", line("stroke='red' " + bad))), 2u) << bad;
  }
  EXPECT_EQ(count(in_group("visibility='hidden'", line("stroke='red' visibility='yes'"))), 0u);
  EXPECT_EQ(count(in_group("stroke-opacity='0'", line("stroke='red' stroke-opacity='1px'"))), 0u);
}

// One invalid selector voids its rule; one that is valid but not understood does not.
TEST_F(SvgValidity, InvalidSelectorsVoidTheirRule) {
  const auto is_hidden_by = [&](const std::string& selectors) {
    return count("<style>" + selectors +
                 "{display:none}</style><rect class='a' width='5' height='5'/>") == 0;
  };
  for (const std::string invalid :
       {":foo", "::foo", "",      "b..c", ".1b",      "#2", "b >", "> b",   "b > > c",    "b + ~ c",
        "[",    "[=1]",  "[a!b]", "!",    "b:foo(x)", "b:", "1b",  "b @ c", ":hover:foo", "%"})
    for (const std::string& list :
         {".a," + invalid, invalid + ",.a", ".b,.a ," + invalid + ",rect"})
      EXPECT_FALSE(is_hidden_by(list)) << list;
  for (const std::string valid :
       {"b", ":hover", "b:nth-child(2n + 1)", "b + c", "b ~ c", "[b~='c']", "[b|='c' i]",
        "b::before", "c:after", "b:not(.c, .d)", "b:first-child > c", "svg|b", ".b\\:c", "*.z"})
    for (const std::string& list : {".a," + valid, valid + ",.a"})
      EXPECT_TRUE(is_hidden_by(list)) << list;
  EXPECT_THAT(shapes("<style>.a,:foo,:bar{fill:none}</style><rect width='1' height='1'/>").left_out,
              ElementsAre(Pair(StartsWith("rule of a style sheet, first '"), 1u)));
}

TEST_F(SvgValidity, ConditionsHoldEverywhere) {
  for (const std::string condition : {"systemLanguage='de'", "systemLanguage=''",
                                      "systemLanguage='de, engl'", "requiredExtensions='x'"}) {
    const std::string rect = "<rect width='5' height='5' ";
    for (const std::string& content :
         {fmt::format("{}{}/>", rect, condition), fmt::format("<g {}>{}/></g>", condition, rect),
          fmt::format("<defs>{}id='r'/></defs><use href='#r' {}/>", rect, condition),
          fmt::format("<defs>{}id='r' {}/></defs><use href='#r'/>", rect, condition),
          fmt::format("<defs><svg id='r' {}>{}/></svg></defs><use href='#r'/>", condition, rect)})
      EXPECT_EQ(count(content), 0u) << content;
  }
  for (const std::string condition : {"systemLanguage='en'", "systemLanguage='de, EN-gb'",
                                      "systemLanguage='en-US,fr'", "requiredExtensions=''"})
    EXPECT_EQ(count("<rect width='5' height='5' " + condition + "/>"), 1u) << condition;
}

TEST_F(SvgValidity, ReferencesHaveManyForms) {
  const std::string defs =
      "<defs><rect id='a b' width='5' height='5'/><rect id='\xC3\xA9' width='5' height='5'/>"
      "<rect id='c%20d' width='5' height='5'/><clipPath id='k l'><rect width='2' height='9'/>"
      "</clipPath></defs>";
  for (const std::string href : {"#a b", "#a%20b", " #a%20b ", "#%C3%A9", "#%c3%a9", "\n#\xC3\xA9",
                                 "#c%20d", "#c%2520d", "\t#a b\n"})
    EXPECT_EQ(count(fmt::format("{}<use href='{}'/>", defs, href)), 1u) << href;
  for (const std::string href : {"#a%2", "#a%zzb", "#%"})
    EXPECT_THAT(error(fmt::format("{}<use href='{}'/>", defs, href)),
                HasSubstr("there is no element"));
  for (const std::string url :
       {"url(#k%20l)", "url( #k%20l )", "url(&quot;#k l&quot;)", "url( &apos;#k%20l&apos; )"})
    EXPECT_NEAR(length(fmt::format("{}<path fill='none' stroke='red' d='M0 1H9' clip-path='{}'/>",
                                   defs, url)),
                2, 1e-6)
        << url;
}

// The transform of the page applies to px, before its view box.
TEST_F(SvgValidity, ThePageHasATransform) {
  const auto box = [&](const std::string& attributes) {
    return model::bounds(read("<svg width='60mm' height='60mm' viewBox='0 0 30 30' " + attributes +
                              "><rect x='5' y='5' width='10' height='10'/></svg>"));
  };
  constexpr double px = 25.4 / 96;
  EXPECT_NEAR(box("transform='translate(10 20)'").low.x, 10 + 10 * px, 1e-9);
  EXPECT_NEAR(box("style='transform:translate(10px,20px)'").high.y, 50 - 20 * px, 1e-9);
  EXPECT_NEAR(box("transform='scale(.5)'").low.x, 5, 1e-9);
  EXPECT_NEAR(box("transform='scale(.5)'").high.y, 55, 1e-9);
  EXPECT_NEAR(box("transform='rotate(90)' transform-origin='50% 50%'").low.x, 30, 1e-9);
  EXPECT_NEAR(box("transform='rotate(90)' transform-origin='50% 50%'").high.y, 50, 1e-9);
}

// Dashes of a stroke that does not scale are px of the page, however the path is mapped.
TEST_F(SvgValidity, DashesOfStrokesThatDoNotScale) {
  constexpr double mm = 96 / 25.4;
  const std::string dashes =
      fmt::format("fill='none' stroke='red' stroke-dasharray='{} {}' ", 3 * mm, 1 * mm);
  for (const std::string map : {"scale(2)", "scale(2 5)", "rotate(30) scale(2 9)"})
    for (const std::string how :
         {"vector-effect='non-scaling-stroke'", "style='vector-effect:non-scaling-stroke'"}) {
      const std::string line = fmt::format("<line x2='20' transform='{}' {}{}/>", map, dashes, how);
      EXPECT_EQ(shapes(line).paths.size(), 10u) << line;
      EXPECT_NEAR(length(line), 30, 1e-6) << line;
    }
}

// A dash that begins where the curve ends is no point.
TEST_F(SvgValidity, NoDashBeginsAtTheEnd) {
  const auto dashes = [&](const std::string& d, const std::string& pattern) {
    return shapes("<path fill='none' stroke='red' stroke-linecap='round' d='" + d +
                  "' stroke-dasharray='" + pattern + "'/>");
  };
  for (const std::string pattern : {"3 1", ".3 .1", "1 1", ".7 .1", "2 2 2 2"}) {
    for (const std::string d : {"M0 0H40", "M7 3l24 32", "M0 0L8 0L8 8L16 8L16 16L24 16", "M0 0V8"})
      for (const model::Path& path : dashes(d, pattern).paths)
        EXPECT_GT(model::ArcLength(path).total(), 0.09) << d << " " << pattern;
  }
  EXPECT_EQ(dashes("M0 0H40", "0 4").paths.size(), 10u);
  EXPECT_EQ(dashes("M0 0H40", "0 4 0 4").paths.size(), 10u);
  EXPECT_EQ(dashes("M0 0H41", "0 4").paths.size(), 11u);
}

TEST_F(SvgValidity, WhatIsLeftOutHasPlurals) {
  Curves curves;
  curves.left_out = {{"rule of a style sheet", 2},
                     {"clipped curve", 1},
                     {"entity of another file", 3},
                     {"element of another namespace", 1},
                     {"hidden", 2},
                     {"use of another file", 2},
                     {"text", 4},
                     {"use", 2},
                     {"style sheet of another file", 2}};
  EXPECT_EQ(
      left_out_text(curves),
      "1 clipped curve, 1 element of another namespace, 3 entities of another file, 2 hidden, "
      "2 rules of a style sheet, 2 style sheets of another file, 4 text, 2 use, 2 uses of "
      "another file");
}

}  // namespace
}  // namespace lamplock::svg_validity_test
