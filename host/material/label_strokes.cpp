#include "host/material/label_strokes.hpp"

#include <utility>

namespace lamplock::material {
namespace {

/// Letters are 4 wide and 6 high, and 6 apart.
constexpr int glyph_width = 4, glyph_height = 6, glyph_advance = 6;

/// Pairs of digits, x and y; a blank lifts the beam.
constexpr std::string_view glyph_of(char letter) {
  switch (letter) {
    case '0':
      return "0040460600";
    case '1':
      return "152620";
    case '2':
      return "064643030040";
    case '3':
      return "06464000 0343";
    case '4':
      return "060343 4640";
    case '5':
      return "460603434000";
    case '6':
      return "460600404303";
    case '7':
      return "064610";
    case '8':
      return "0040460600 0343";
    case '9':
      return "4046060343";
    case '.':
      return "1020";
    case 'F':
      return "000646 0333";
    case 'N':
      return "00064046";
    case 'P':
      return "0006464303";
    case 'W':
      return "0610233046";
    default:
      return "";
  }
}

}  // namespace

std::vector<Stroke> label_strokes(std::string_view text, double height_mm) {
  const double unit_mm = height_mm / glyph_height;
  std::vector<Stroke> strokes;
  double left_mm = 0;
  for (const char letter : text) {
    const std::string_view glyph = glyph_of(letter);
    Stroke stroke;
    for (std::size_t i = 0; i < glyph.size(); ++i) {
      if (glyph[i] == ' ') {
        strokes.push_back(std::exchange(stroke, {}));
        continue;
      }
      const int x = glyph[i] - '0', y = glyph[++i] - '0';
      stroke.push_back({left_mm + x * unit_mm, y * unit_mm});
    }
    if (!stroke.empty()) strokes.push_back(std::move(stroke));
    left_mm += glyph_advance * unit_mm;
  }
  return strokes;
}

double label_width_mm(std::string_view text, double height_mm) {
  if (text.empty()) return 0;
  const auto letters = static_cast<double>(text.size());
  return (letters * glyph_advance - (glyph_advance - glyph_width)) * height_mm / glyph_height;
}

}  // namespace lamplock::material
