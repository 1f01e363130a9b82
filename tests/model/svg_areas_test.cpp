// Filled areas of an SVG: which paths are one outline, and by which rule it is filled.
#include <gtest/gtest.h>

#include <cstddef>
#include <string>

#include "tests/model/svg_page.hpp"

namespace lamplock::test::svg_areas {
namespace {

using model::FillRule;
using SvgAreas = SvgPage;

const std::string two = "<path d='M0 0h9v9h-9z M2 2h5v5h-5z'/>";

TEST_F(SvgAreas, paths_of_an_element_are_one_area) {
  const model::Curves curves = shapes(two + two + "<rect width='4' height='4'/>");
  ASSERT_EQ(curves.paths.size(), 5u);
  EXPECT_NE(curves.paths[0].area, 0u);
  EXPECT_EQ(curves.paths[0].area, curves.paths[1].area);
  EXPECT_EQ(curves.paths[2].area, curves.paths[3].area);
  EXPECT_NE(curves.paths[1].area, curves.paths[2].area);
  EXPECT_NE(curves.paths[3].area, curves.paths[4].area);
  for (const model::Path& path : curves.paths) EXPECT_EQ(path.fill_rule, FillRule::non_zero);
}

TEST_F(SvgAreas, the_rule_is_inherited_and_that_of_the_cascade) {
  const auto rule_of = [&](const std::string& content) {
    return shapes(content).paths.at(0).fill_rule;
  };
  const auto square = [](const std::string& more) {
    return "<path d='M0 0h9v9h-9z' " + more + "/>";
  };
  EXPECT_EQ(rule_of(square("fill-rule='evenodd'")), FillRule::even_odd);
  EXPECT_EQ(rule_of("<g fill-rule='EvenOdd'>" + square("") + "</g>"), FillRule::even_odd);
  EXPECT_EQ(rule_of("<g fill-rule='evenodd'>" + square("fill-rule='nonzero'") + "</g>"),
            FillRule::non_zero);
  EXPECT_EQ(rule_of("<style>path{fill-rule:evenodd}</style>" + square("fill-rule='nonzero'")),
            FillRule::even_odd);
  EXPECT_EQ(rule_of("<g fill-rule='evenodd'>" + square("style='fill-rule:initial'") + "</g>"),
            FillRule::non_zero);
  EXPECT_EQ(rule_of(square("fill-rule='odd'")), FillRule::non_zero) << "not valid: ignored";
}

TEST_F(SvgAreas, lines_have_none_and_areas_in_the_colour_of_the_page_cover_others) {
  for (const std::string more : {"fill='none' stroke='red'", "fill-opacity='0' stroke='red'"})
    EXPECT_EQ(shapes("<rect width='4' height='4' " + more + "/>").paths.at(0).area, 0u) << more;
  for (const std::string more : {"fill='white'", "fill='#fff' stroke='red'"}) {
    const model::Path path = shapes("<rect width='4' height='4' " + more + "/>").paths.at(0);
    EXPECT_NE(path.area, 0u) << more;
    EXPECT_TRUE(path.covers) << more;
  }
  EXPECT_NE(shapes("<rect width='4' height='4' fill='red' stroke='lime'/>").paths.at(0).area, 0u);
}

TEST_F(SvgAreas, texts_are_areas) {
  const auto path = folder_.write(
      "text.svg", svg_page("<rect width='4' height='4'/><text y='9'>ab<tspan fill='white'>c</tspan>"
                           "<tspan fill='red'>d</tspan></text>"));
  const model::LetteredDrawing drawing = model::read_svg_with_texts(path);
  ASSERT_EQ(drawing.texts.size(), 3u);
  EXPECT_GT(drawing.texts[0].area, drawing.curves.paths.at(0).area);
  EXPECT_GT(drawing.texts[1].area, drawing.texts[0].area);
  EXPECT_GT(drawing.texts[2].area, drawing.texts[1].area);
  EXPECT_FALSE(drawing.texts[0].covers);
  EXPECT_TRUE(drawing.texts[1].covers);
}

}  // namespace
}  // namespace lamplock::test::svg_areas
