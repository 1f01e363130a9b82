// Entities of SVG files: in attributes, content and style sheets, nested, of other files, bombs.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "host/model/xml_entities.hpp"
#include "tests/model/svg_page.hpp"
#include "tests/scale.hpp"

namespace lamplock::svg_entities_test {
namespace {

using model::Curves;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;

class SvgEntities : public test::SvgPage {
 protected:
  static std::string page(const std::string& subset, const std::string& content) {
    return "<?xml version='1.0'?>\n<!DOCTYPE svg PUBLIC \"-//W3C//DTD SVG 1.1//EN\" "
           "\"http://www.w3.org/svg11.dtd\" [\n" +
           subset + "\n]>\n<svg xmlns='http://www.w3.org/2000/svg' width='100' height='80'>" +
           content + "</svg>";
  }
  Curves with(const std::string& subset, const std::string& content) {
    return read(page(subset, content));
  }
  std::string error_with(const std::string& subset, const std::string& content) {
    const auto path = folder_.write("a.svg", page(subset, content));
    return test::error_of([&] { model::read_svg(path); });
  }
};

TEST_F(SvgEntities, StylesOfEntitiesHideAndShow) {
  const std::string subset =
      "<!ENTITY st0 \"fill:none;stroke:none;\">\n<!ENTITY st1 'fill:red;'>"
      "<!-- <!ENTITY st1 'fill:none'> --><!ENTITY st1 'fill:none'>";
  const Curves curves = with(subset,
                             "<rect width='5' height='5' style='&st0;'/>"
                             "<rect width='1' height='1' style='&st0;&st1;'/>");
  ASSERT_EQ(curves.paths.size(), 1u);
  EXPECT_NEAR(length(curves), 4 * 25.4 / 96, 1e-9);
  EXPECT_THAT(curves.left_out, ElementsAre(Pair("hidden", 1u)));
  EXPECT_EQ(with("<!ENTITY h '.h{display:none}'>",
                 "<style>&h;</style><rect class='h' width='5' height='5'/><circle r='1'/>")
                .paths.size(),
            1u);
}

TEST_F(SvgEntities, LengthsNamespacesAndContent) {
  const Curves curves = with(
      "<!ENTITY w \"2&#x35;.4\"><!ENTITY % all \"<!ENTITY b '<g id=&#34;&n;&#34;>&r;</g>'>\">\n"
      "%all;<!ENTITY r '<rect width=\"&w;mm\"\n height=\"&w;mm\"/>'>\n<!ENTITY n 'x'>",
      "&b;");
  ASSERT_EQ(curves.paths.size(), 1u);
  EXPECT_NEAR(length(curves), 4 * 25.4, 1e-9);
  EXPECT_THAT(curves.layers, ElementsAre("x"));
  EXPECT_EQ(read("<!DOCTYPE svg [<!ENTITY ns 'http://www.w3.org/2000/svg'>]>"
                 "<svg xmlns='&ns;' width='9' height='9'><circle r='1'/></svg>")
                .paths.size(),
            1u);
}

TEST_F(SvgEntities, NothingIsAReferenceInCdataCommentsAndPredefinedEntities) {
  const std::string subset = "<!ENTITY e '<rect width=\"1\" height=\"1\"/>'><!ENTITY lt '&e;'>";
  const Curves curves =
      with(subset, "<!-- &e; --><desc><![CDATA[&e;]]></desc><text>&lt;&amp;e; a & b</text>&e;");
  EXPECT_EQ(curves.paths.size(), 1u);
  EXPECT_THAT(curves.left_out, ElementsAre(Pair("text", 1u)));
  // Quotes and "<" of a replacement text do not end the attribute.
  EXPECT_EQ(
      with("<!ENTITY q '\"&#62;&#60;'>", "<rect id=\"&q;\" width='1' height='1'/>").layers.size(),
      1u);
}

TEST_F(SvgEntities, EntitiesOfOtherFilesAndUndeclaredOnesAreCounted) {
  const Curves curves = with("<!ENTITY x SYSTEM \"part.svg\"><!ENTITY % y PUBLIC 'a' 'b'> %y;",
                             "&x;<rect width='1' height='1' style='&x;&none;'/>");
  EXPECT_EQ(curves.paths.size(), 1u);
  EXPECT_THAT(curves.left_out, ElementsAre(Pair("entity of another file", 3u),
                                           Pair("entity without a declaration", 1u)));
  EXPECT_THAT(with("<!ENTITY x SYSTEM \"part.svg\">", "<circle r='1'/>").left_out, IsEmpty());
  EXPECT_THAT(read("<?xml-stylesheet href='a.css'?><svg width='9' height='9'><circle r='1'/></svg>")
                  .left_out,
              ElementsAre(Pair("style sheet of another file", 1u)));
}

TEST_F(SvgEntities, BombsAreRefusedByName) {
  std::string laughs = "<!ENTITY lol0 '" + std::string(4000, '#') + "'>", empty = "<!ENTITY e0 ''>";
  for (int i = 1; i < 10; ++i) {
    std::string ten, ten_empty;
    for (int k = 0; k < 10; ++k) {
      ten += fmt::format("&lol{};", i - 1);
      ten_empty += fmt::format("&e{};", i - 1);
    }
    laughs += fmt::format("<!ENTITY lol{} '{}'>\n", i, ten);
    empty += fmt::format("<!ENTITY e{} '{}'>\n", i, ten_empty);
  }
  for (const std::string content : {"&lol9;", "<g id='&lol9;'/>"})
    EXPECT_THAT(error_with(laughs, content),
                AllOf(HasSubstr("the entity 'lol9'"), HasSubstr("MB")));
  EXPECT_THAT(error_with(empty, "&e9;"),
              AllOf(HasSubstr("the entity 'e9'"), HasSubstr("references")));
  EXPECT_THAT(error_with("<!ENTITY a '&b;'><!ENTITY b '&a;'>", "\n&a;"),
              AllOf(HasSubstr("line 6"), HasSubstr("refers to itself")));
  EXPECT_THAT(error_with("<!ENTITY % p '&#37;p;'> %p;", ""), HasSubstr("refers to itself"));
  EXPECT_THAT(error_with("<!ENTITY a '<rect\n\n\n'>", "\n\n<rect width='x'/>"),
              HasSubstr("line 10"));
}

// Against an expansion that calls itself for each reference.
TEST_F(SvgEntities, RandomEntitiesExpandAsByDefinition) {
  std::mt19937 random(9);
  const auto below = [&](std::size_t n) { return std::size_t{random() % n}; };
  for (int round = 0; round < test::scaled(400); ++round) {
    std::vector<std::string> plain{""};
    std::string subset;
    const auto text = [&](std::string& expanded) {
      std::string written;
      for (std::size_t parts = below(5); parts > 0; --parts) {
        const std::size_t used = below(plain.size());
        const std::string word = fmt::format("w{} ", below(100));
        written += used == 0 ? word : fmt::format("&e{};", used);
        expanded += used == 0 ? word : plain[used];
      }
      return written;
    };
    for (std::size_t i = 1; i < 8; ++i) {
      std::string expanded;
      subset += fmt::format("<!ENTITY e{} '{}'>", i, text(expanded));
      plain.push_back(expanded);
    }
    std::string content, attribute;
    const std::string written = text(content), in_attribute = text(attribute);
    const std::string head = "<!DOCTYPE svg [" + subset + "]>";
    EXPECT_EQ(
        model::expand_entities("a", head + fmt::format("<a b='{}'>{}</a>", in_attribute, written))
            .text,
        head + fmt::format("<a b='{}'>{}</a>", attribute, content));
  }
}

}  // namespace
}  // namespace lamplock::svg_entities_test
