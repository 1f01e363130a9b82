// Letters of single strokes: every printable character of ASCII, heights, places in blocks.
#include "host/lettering/stroke_letters.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <variant>

#include "host/lettering/text_curves.hpp"

namespace lamplock::lettering::stroke_letters_test {
namespace {

geometry::Bounds bounds_of(const LetteredLine& line) {
  model::Curves curves;
  curves.paths = line.paths;
  return model::bounds(curves);
}

TEST(stroke_letters, every_printable_character_of_ascii_has_strokes) {
  const StrokeLetters letters;
  for (char c = '!'; c <= '~'; ++c) {
    const LetteredLine line = letters.line(std::string(1, c));
    EXPECT_EQ(line.missing, 0U) << c;
    ASSERT_FALSE(line.paths.empty()) << c;
    EXPECT_TRUE(std::none_of(line.paths.begin(), line.paths.end(), [](const model::Path& path) {
      return path.pieces.empty();
    })) << c;
    const geometry::Bounds box = bounds_of(line);
    EXPECT_GE(box.low.y, -letters.descent() - 1e-9) << c;
    EXPECT_GE(box.low.x, 0) << c;
    EXPECT_LT(box.high.x, line.width) << c;
  }
  for (const char* latin : {"ä", "Ö", "ß", "é", "ñ", "å", "°", "µ", "×"})
    EXPECT_EQ(letters.line(latin).missing, 0U) << latin;
}

/// Two letters differ, unless they look alike in print.
TEST(stroke_letters, capitals_and_digits_have_one_height_and_differ) {
  const StrokeLetters letters;
  const std::string all = "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789";
  for (const char c : all) {
    const geometry::Bounds box = bounds_of(letters.line(std::string(1, c)));
    EXPECT_NEAR(box.low.y, 0, 1e-9) << c;
    EXPECT_NEAR(box.high.y, letters.capital(), 1e-9) << c;
  }
  const auto length = [&](char c) {
    double sum = 0;
    for (const model::Path& path : letters.line(std::string(1, c)).paths)
      for (const model::Piece& piece : path.pieces) {
        const auto& line = std::get<model::Line>(piece);
        // Weighted by the place, so that mirrored letters differ.
        sum += std::hypot(line.to.x - line.from.x, line.to.y - line.from.y) *
               (1 + line.to.x + 3 * line.from.y);
      }
    return sum;
  };
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t k = i + 1; k < all.size(); ++k)
      EXPECT_NE(length(all[i]), length(all[k])) << all[i] << all[k];
}

TEST(stroke_letters, a_line_is_as_wide_as_its_letters_and_counts_what_is_missing) {
  const StrokeLetters letters;
  EXPECT_NEAR(letters.line("AB1").width,
              letters.line("A").width + letters.line("B").width + letters.line("1").width, 1e-9);
  EXPECT_EQ(letters.line("A 漢 B").missing, 1U);
  EXPECT_EQ(letters.line("A \xff B").missing, 1U) << "a byte that is not UTF-8";
  EXPECT_EQ(letters.line("").width, 0);
}

}  // namespace
}  // namespace lamplock::lettering::stroke_letters_test
