// Text elements of SVG files: runs of characters and their places.
#include "host/model/svg_text.hpp"

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "host/error.hpp"
#include "host/model/read_svg.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::model::svg_text_test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::Pair;

/// A page of 100 x 100 mm whose unit is a mm.
LetteredDrawing drawing_of(const std::string& body) {
  const lamplock::test::TemporaryFolder folder;
  return read_svg_with_texts(folder.write("a.svg",
                                          "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' "
                                          "height='100mm' viewBox='0 0 100 100'>" +
                                              body + "</svg>"));
}
std::vector<TextBlock> runs_of(const std::string& body) { return drawing_of(body).texts; }
std::vector<std::string> lines_of(const std::vector<TextBlock>& runs) {
  std::vector<std::string> lines;
  for (const TextBlock& run : runs) lines.push_back(run.lines.at(0));
  return lines;
}
void expect_at(const TextBlock& run, const geometry::Point& of, double x, double y) {
  const geometry::Point at = run.frame(of);
  EXPECT_NEAR(at.x, x, 1e-9);
  EXPECT_NEAR(at.y, y, 1e-9);
}

TEST(SvgText, place_size_and_colour) {
  const auto runs = runs_of("<text x='10' y='20' font-size='5' fill='red'>  a  b\n c\t</text>");
  ASSERT_THAT(lines_of(runs), ElementsAre("a b c"));
  EXPECT_EQ(runs[0].size, 5);
  EXPECT_EQ(runs[0].unit, TextUnit::em);
  EXPECT_EQ(runs[0].colour, 0xff0000u);
  expect_at(runs[0], {0, 0, 0}, 10, 80);
  expect_at(runs[0], {1, 1, 0}, 11, 81);
  const auto turned =
      runs_of("<g transform='translate(50 50) rotate(90) scale(2)'><text>a</text></g>");
  expect_at(turned.at(0), {0, 0, 0}, 50, 50);
  expect_at(turned.at(0), {1, 0, 0}, 50, 48);
  EXPECT_THAT(lines_of(runs_of("<text xml:space='preserve'> a  b </text>")), ElementsAre(" a  b "));
  EXPECT_TRUE(drawing_of("<text>a</text>").curves.left_out.empty());
}

TEST(SvgText, the_size_is_that_of_the_shorthand) {
  const auto size_of = [](const std::string& font) {
    return runs_of("<g font-size='7'><text style='font: " + font + "'>a</text></g>").at(0).size;
  };
  EXPECT_EQ(size_of("bold 20px serif"), 20);
  EXPECT_EQ(size_of("italic 700 1.5em/1.2 \"Noto Sans\", sans"), 10.5);
  EXPECT_EQ(size_of("small-caps x-large serif"), 24);
  EXPECT_EQ(size_of(".5rem serif"), 8);
  EXPECT_EQ(size_of("inherit"), 7);
  EXPECT_EQ(size_of("caption"), 7) << "no size";
  EXPECT_EQ(runs_of("<style>.t{font:12px a}</style><text class='t'>a</text>").at(0).size, 12);
}

TEST(SvgText, letters_and_words_are_apart) {
  const auto runs =
      runs_of("<text letter-spacing='10' word-spacing='3'>ab c<tspan x='9'>d</tspan></text>");
  ASSERT_THAT(lines_of(runs), ElementsAre("a", "b", " ", "c", "d"));
  EXPECT_EQ(runs[0].shift_x, 0);
  EXPECT_EQ(runs[1].shift_x, 10);
  EXPECT_EQ(runs[2].shift_x, 10);
  EXPECT_EQ(runs[3].shift_x, 13);
  EXPECT_FALSE(runs[4].follows);
  expect_at(runs[4], {0, 0, 0}, 9, 100);
  EXPECT_THAT(lines_of(runs_of("<text style='letter-spacing:normal'>ab</text>")),
              ElementsAre("ab"));
  EXPECT_EQ(
      runs_of("<g font-size='4' style='letter-spacing:.5em'><text>ab</text></g>").at(1).shift_x, 2);
}

TEST(SvgText, properties_that_are_not_read_are_named) {
  const auto left_out = [](const std::string& body) { return drawing_of(body).curves.left_out; };
  EXPECT_THAT(left_out("<text textLength='50'>a</text>"),
              Contains(Pair("textLength of a text", 1)));
  EXPECT_THAT(left_out("<g style='text-transform: uppercase'><text>a<tspan>b</tspan></text></g>"),
              ElementsAre(Pair("text-transform of a text", 1)));
  EXPECT_THAT(left_out("<text>a<tspan text-decoration='underline'>b</tspan></text>"),
              ElementsAre(Pair("text-decoration of a text", 1)));
  EXPECT_TRUE(
      left_out("<text text-decoration='none' writing-mode='horizontal-tb'>a</text>").empty());
}

TEST(SvgText, runs_continue_or_have_places) {
  const auto lines = runs_of(
      "<text x='1' y='2'><tspan x='1' y='2'>one</tspan><tspan x='1' y='12'>two</tspan></text>");
  ASSERT_THAT(lines_of(lines), ElementsAre("one", "two"));
  EXPECT_FALSE(lines[1].follows);
  expect_at(lines[1], {0, 0, 0}, 1, 88);
  const auto styles = runs_of(
      "<text x='1' y='9' font-size='5'>one <tspan dx='2' dy='4' font-size='3' fill='blue'>two"
      "</tspan> three</text>");
  ASSERT_THAT(lines_of(styles), ElementsAre("one ", "two", " three"));
  EXPECT_TRUE(styles[1].follows);
  EXPECT_EQ(styles[1].shift_x, 2);
  EXPECT_EQ(styles[1].shift_y, -4);
  EXPECT_EQ(styles[1].size, 3);
  EXPECT_EQ(styles[1].colour, 0x0000ffu);
  EXPECT_TRUE(styles[2].follows);
  EXPECT_EQ(styles[2].shift_y, -4) << "the baseline stays";
  EXPECT_EQ(styles[2].size, 5);
  const auto letters = runs_of("<text x='1 3 9' y='5'>abcd</text>");
  ASSERT_THAT(lines_of(letters), ElementsAre("a", "b", "cd"));
  expect_at(letters[2], {0, 0, 0}, 9, 95);
  EXPECT_THAT(lines_of(runs_of("<text><tspan>a</tspan> <tspan>b</tspan></text>")),
              ElementsAre("a", " ", "b"));
}

TEST(SvgText, anchors_are_inherited) {
  const auto runs = runs_of(
      "<g text-anchor='middle'><text>a</text><text style='text-anchor:end'>b</text></g>"
      "<text dominant-baseline='central'>c</text>");
  ASSERT_EQ(runs.size(), 3u);
  EXPECT_EQ(runs[0].align, 0.5);
  EXPECT_EQ(runs[1].align, 1);
  EXPECT_EQ(runs[2].align, 0);
  EXPECT_EQ(runs[2].anchor, TextAnchor::middle);
}

TEST(SvgText, what_is_hidden_clipped_or_on_a_path) {
  const auto runs = runs_of(
      "<text>a<tspan visibility='hidden'>b</tspan><tspan display='none'>c</tspan>d</text>"
      "<text display='none'>e</text>");
  ASSERT_THAT(lines_of(runs), ElementsAre("a", "b", "d"));
  EXPECT_TRUE(runs[0].is_drawn);
  EXPECT_FALSE(runs[1].is_drawn);
  EXPECT_TRUE(runs[2].is_drawn);
  const auto drawing = drawing_of(
      "<clipPath id='c'><rect width='9' height='9'/></clipPath><rect width='5' height='5'/>"
      "<text clip-path='url(#c)'>a</text><text><textPath href='#p'>b</textPath></text>");
  EXPECT_TRUE(drawing.texts.empty());
  EXPECT_EQ(drawing.curves.left_out.at("text that is clipped"), 1u);
  EXPECT_EQ(drawing.curves.left_out.at("textPath"), 1u);
  EXPECT_THROW(runs_of("<text x='abc'>a</text>"), Error);
}

}  // namespace
}  // namespace lamplock::model::svg_text_test
