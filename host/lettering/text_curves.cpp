#include "host/lettering/text_curves.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace lamplock::lettering {
namespace {

using model::TextAnchor;
using model::TextBlock;
using model::TextUnit;

/// Breaks a line at blanks where it is longer than `width`, in font sizes. A longer word is whole.
std::vector<std::string> wrapped(const std::string& line, double width, const Font& font) {
  std::vector<std::string> lines;
  std::string begun;
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t end = std::min(line.find(' ', at), line.size());
    const std::string word = line.substr(at, end - at);
    const std::string longer = at == 0 ? word : begun + " " + word;
    const bool fits = begun.empty() || font.line(longer).width <= width;
    if (!fits) lines.push_back(std::exchange(begun, word));
    if (fits) begun = longer;
    at = end + 1;
  }
  lines.push_back(begun);
  return lines;
}

/// Height of the baseline of the first line; `descent` and heights are in units of the block.
double first_baseline(const TextBlock& block, std::size_t lines, double descent) {
  const double others = static_cast<double>(lines - 1) * block.line_step;
  switch (block.anchor) {
    case TextAnchor::baseline:
      return 0;
    case TextAnchor::bottom:
      return others + descent;
    case TextAnchor::middle:
      return (others - 1) / 2;
    case TextAnchor::top:
      return -1;
  }
  return 0;
}

}  // namespace

TextCurves text_curves(const TextBlock& block, const Font& font) {
  // Capital letters are 1 high, or the font size is 1.
  const double size = block.unit == TextUnit::capital ? 1 / font.capital() : 1;
  std::vector<std::string> lines;
  for (const std::string& line : block.lines) {
    const std::vector<std::string> parts = block.wrap_width > 0
                                               ? wrapped(line, block.wrap_width / size, font)
                                               : std::vector<std::string>{line};
    lines.insert(lines.end(), parts.begin(), parts.end());
  }
  TextCurves curves;
  double y = first_baseline(block, lines.size(), font.descent() * size);
  for (const std::string& line : lines) {
    const LetteredLine letters = font.line(line);
    const double width = letters.width * size;
    const double wide = block.fit_width > 0 && width > 0 ? block.fit_width / width : 1;
    const geometry::Affine map =
        block.frame * geometry::moved(-block.align * width * wide, y, 0) *
        geometry::scaled(size * wide, size * (block.fits_height ? wide : 1), 1);
    for (const model::Path& letter : letters.paths) {
      model::Path path = letter;
      for (model::Piece& piece : path.pieces) piece = transformed(std::move(piece), map);
      path.layer = block.layer;
      path.colour = block.colour;
      curves.paths.push_back(std::move(path));
    }
    curves.missing += letters.missing;
    y -= block.line_step;
  }
  return curves;
}

}  // namespace lamplock::lettering
