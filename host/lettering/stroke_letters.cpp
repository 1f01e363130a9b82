#include "host/lettering/stroke_letters.hpp"

#include <algorithm>
#include <charconv>
#include <functional>
#include <map>
#include <utility>

#include "host/text.hpp"

namespace lamplock::lettering {
namespace {

// Heights in the units of the table, and its unit in font sizes.
constexpr double capital_units = 12, descent_units = 4, gap_units = 4, blank_units = 6;
constexpr double unit = 0.7 / capital_units;

struct Glyph {
  double width = 0;                                   ///< units
  std::vector<std::vector<geometry::Point>> strokes;  ///< units
};

/// The bytes of the character of UTF-8 at the begin of a text; a byte that begins none is one.
std::string_view first_character(std::string_view text) {
  std::size_t size = 1;
  while (size < text.size() && (static_cast<unsigned char>(text[size]) & 0xc0U) == 0x80) ++size;
  return text.substr(0, size);
}

std::string_view take_word(std::string_view& text) {
  const std::size_t end = std::min(text.find(' '), text.size());
  const std::string_view word = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return word;
}

double number_of(std::string_view text) {
  int value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

Glyph glyph_of(std::string_view words) {
  Glyph glyph;
  glyph.width = number_of(take_word(words));
  glyph.strokes.emplace_back();
  while (!words.empty()) {
    const std::string_view word = take_word(words);
    if (word == "/") {
      glyph.strokes.emplace_back();
      continue;
    }
    const std::size_t comma = word.find(',');
    glyph.strokes.back().push_back(
        {number_of(word.substr(0, comma)), number_of(word.substr(comma + 1)), 0});
  }
  return glyph;
}

/// By the bytes of the character.
const std::map<std::string, Glyph, std::less<>>& glyphs() {
  static const auto table = [] {
    std::map<std::string, Glyph, std::less<>> made;
    for (std::string_view rest = strokes_text(); !rest.empty();) {
      std::string_view line = take_line(rest);
      if (line.empty() || line.starts_with("#!")) continue;
      const std::string letter(take_word(line));
      made.emplace(letter, glyph_of(line));
    }
    return made;
  }();
  return table;
}

model::Path path_of(const std::vector<geometry::Point>& stroke, double left) {
  const auto place = [left](const geometry::Point& at) {
    return geometry::Point{(left + at.x) * unit, at.y * unit, 0};
  };
  model::Path path;
  for (std::size_t i = 1; i < stroke.size(); ++i)
    path.pieces.emplace_back(model::Line{place(stroke[i - 1]), place(stroke[i])});
  return path;
}

}  // namespace

LetteredLine StrokeLetters::line(const std::string& text) const {
  LetteredLine line;
  double left = 0;
  for (std::string_view rest = text; !rest.empty();) {
    const std::string_view letter = first_character(rest);
    rest.remove_prefix(letter.size());
    const auto glyph = glyphs().find(letter);
    const bool is_blank = letter == " " || letter == "\t" || letter == "\u00a0";
    if (glyph == glyphs().end()) {
      line.missing += is_blank ? 0 : 1;
      left += blank_units + gap_units;
      continue;
    }
    for (const auto& stroke : glyph->second.strokes) line.paths.push_back(path_of(stroke, left));
    left += glyph->second.width + gap_units;
  }
  line.width = left * unit;
  return line;
}

double StrokeLetters::capital() const { return capital_units * unit; }
double StrokeLetters::descent() const { return descent_units * unit; }

}  // namespace lamplock::lettering
