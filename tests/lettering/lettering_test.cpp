// Texts as outlines: places, sizes and alignment of letters in the font that this computer has.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "host/error.hpp"
#include "host/geometry/random.hpp"
#include "host/lettering/font.hpp"
#include "host/lettering/text_curves.hpp"
#include "tests/scale.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::lettering::test {
namespace {

using geometry::Bounds;
using model::TextAnchor;
using model::TextBlock;
using model::TextUnit;

const Font& font() {
  static const std::unique_ptr<Font> font = font_named("sans");
  return *font;
}

Bounds box_of(const std::vector<model::Path>& paths) {
  model::Curves curves;
  curves.paths = paths;
  return model::bounds(curves);
}

TextBlock block_of(std::vector<std::string> lines) {
  TextBlock block;
  block.lines = std::move(lines);
  block.line_step = 1.5;
  return block;
}

Bounds box_of(const TextBlock& block) { return box_of(text_curves({block}, font()).paths); }

/// Letters with straight ends are as high as others to this.
constexpr double overshoot = 0.03;

TEST(Lettering, LettersAreClosedOutlines) {
  const std::vector<std::pair<std::string, std::size_t>> contours{
      {"H", 1}, {"i", 2}, {"O", 2}, {"B", 3}, {" ", 0}, {"\xc3\x84", 4}, {"H B", 4}};
  for (const auto& [text, count] : contours) {
    const LetteredLine line = font().line(text);
    EXPECT_EQ(line.paths.size(), count) << text;
    EXPECT_GT(line.width, 0) << text;
    EXPECT_EQ(line.missing, 0u) << text;
    for (const model::Path& path : line.paths) {
      EXPECT_TRUE(path.closed);
      const geometry::Point begin = model::start_of(path);
      const geometry::Point end = std::visit(
          [](const auto& piece) {
            if constexpr (std::is_same_v<std::decay_t<decltype(piece)>, model::Spline>)
              return piece.poles.back();
            else if constexpr (std::is_same_v<std::decay_t<decltype(piece)>, model::Line>)
              return piece.to;
            else
              return piece.centre;
          },
          path.pieces.back());
      EXPECT_EQ(begin, end) << text;
    }
  }
  EXPECT_LT(font().line("AV").width, font().line("A").width + font().line("V").width) << "kerning";
  EXPECT_EQ(font().line("\xf4\x80\x80\x81").missing, 1u) << "a private character";
}

TEST(Lettering, CapitalsHaveTheHeightAndAnchorsTheirPlace) {
  const double descent = font().descent() / font().capital();
  const auto heights = [](TextAnchor anchor, std::size_t lines) {
    TextBlock block = block_of(std::vector<std::string>(lines, "HEH"));
    block.anchor = anchor;
    const Bounds box = box_of(block);
    return std::pair(box.low.y, box.high.y);
  };
  const auto expect = [&](TextAnchor anchor, std::size_t lines, double low, double high) {
    EXPECT_NEAR(heights(anchor, lines).first, low, overshoot);
    EXPECT_NEAR(heights(anchor, lines).second, high, overshoot);
  };
  expect(TextAnchor::baseline, 1, 0, 1);
  expect(TextAnchor::middle, 1, -0.5, 0.5);
  expect(TextAnchor::top, 1, -1, 0);
  expect(TextAnchor::bottom, 1, descent, 1 + descent);
  expect(TextAnchor::baseline, 3, -3, 1);
  expect(TextAnchor::middle, 3, -2, 2);
  expect(TextAnchor::top, 3, -4, 0);
  expect(TextAnchor::bottom, 3, descent, 4 + descent);
  TextBlock em = block_of({"H"});
  em.unit = TextUnit::em;
  EXPECT_NEAR(box_of(em).high.y, font().capital(), overshoot);
}

/// Alignment, frames and stretching move and scale the same outlines.
TEST(Lettering, EveryBlockIsAMapOfThePlainLine) {
  geometry::Random random(5);
  for (int i = 0; i < lamplock::test::scaled(60, 10); ++i) {
    std::string text;
    for (int k = 0; k < 1 + i % 9; ++k)
      text += static_cast<char>('A' + static_cast<int>(random.uniform() * 26));
    const Bounds plain = box_of(block_of({text}));
    const double size = 1 / font().capital(), width = font().line(text).width * size;
    TextBlock block = block_of({text});
    block.align = 0.5 * (i % 3);
    block.fit_width = i % 2 == 0 ? 0 : 0.5 + 20 * random.uniform();
    block.fits_height = i % 4 == 1;
    block.layer = 7;
    block.colour = 0x123456;
    const double height = 0.1 + 30 * random.uniform();
    const geometry::Affine frame = geometry::moved(random.uniform(), -random.uniform(), 0) *
                                   geometry::turned_about_z(90 * (i % 4)) *
                                   geometry::scaled(height, height, 1);
    block.frame = frame;
    const double wide = block.fit_width > 0 ? block.fit_width / width : 1;
    const double high = block.fits_height ? wide : 1;
    const auto at = [&](double x, double y) {
      return frame({(x - block.align * width) * wide, y * high, 0});
    };
    const TextCurves curves = text_curves({block}, font());
    const Bounds box = box_of(curves.paths);
    const geometry::Point a = at(plain.low.x, plain.low.y), b = at(plain.high.x, plain.high.y);
    EXPECT_NEAR(box.low.x, std::min(a.x, b.x), 1e-3 * height) << text;
    EXPECT_NEAR(box.low.y, std::min(a.y, b.y), 1e-3 * height) << text;
    EXPECT_NEAR(box.high.x, std::max(a.x, b.x), 1e-3 * height) << text;
    EXPECT_NEAR(box.high.y, std::max(a.y, b.y), 1e-3 * height) << text;
    for (const model::Path& path : curves.paths) {
      EXPECT_EQ(path.layer, 7u);
      EXPECT_EQ(path.colour, 0x123456u);
    }
  }
}

TEST(Lettering, LongLinesAreBrokenAtBlanks) {
  const std::string text = "one two three four five six seven";
  for (const double width : {1.0, 4.0, 9.0, 15.0, 1000.0}) {
    TextBlock block = block_of({text});
    block.wrap_width = width;
    const Bounds box = box_of(block);
    const double longest = font().line("seven").width / font().capital();
    EXPECT_LE(box.high.x, std::max(width, longest) + 0.2);
    const double lines = std::round(-box.low.y / 1.5) + 1;
    if (width == 1.0) {
      EXPECT_EQ(lines, 7);
    }
    if (width == 1000.0) {
      EXPECT_EQ(lines, 1);
    }
  }
}

TEST(Lettering, RefusesWhatIsNoFont) {
  const lamplock::test::TemporaryFolder folder;
  EXPECT_THROW(font_named(folder.write("a.ttf", "no font").string()), Error);
  EXPECT_THROW(font_named(folder.write("b.ttf", "").string()), Error);
  EXPECT_THROW(font_named(folder.file("none.ttf").string()), Error);
  EXPECT_NO_THROW(font_named(font().name()));
  // fontconfig itself has a font for every name.
  for (const char* unknown : {"nofont", "nofont:bold", "No Such Font-12"})
    EXPECT_THROW(font_named(unknown), Error) << unknown;
  for (const char* generic :
       {"sans", "Sans", "serif", "mono", "monospace", "sans-serif:bold", ":bold"})
    EXPECT_NO_THROW(font_named(generic)) << generic;
}

}  // namespace
}  // namespace lamplock::lettering::test
