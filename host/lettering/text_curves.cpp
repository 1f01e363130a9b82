#include "host/lettering/text_curves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

namespace lamplock::lettering {
namespace {

using model::TextAnchor;
using model::TextBlock;
using model::TextUnit;

/// Breaks a line at blanks where it is longer than `width`, in font sizes. A longer word is whole.
std::vector<std::string> wrapped(const std::string& line, double width, const Letters& font) {
  std::vector<std::string> lines;
  std::string begun;
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t end = std::min(line.find(' ', at), line.size());
    const std::string word = line.substr(at, end - at);
    const std::string longer = at == 0 ? word : fmt::format("{} {}", begun, word);
    const bool fits = begun.empty() || font.line(longer).width <= width;
    if (!fits) lines.push_back(std::exchange(begun, word));
    if (fits) begun = longer;
    at = end + 1;
  }
  lines.push_back(begun);
  return lines;
}

/// Height of the baseline of the first line.
double first_baseline(const TextBlock& block, std::size_t lines, double size, const Letters& font) {
  const double capital = font.capital() * size;
  const double others = static_cast<double>(lines - 1) * block.line_step;
  switch (block.anchor) {
    case TextAnchor::baseline:
      return 0;
    case TextAnchor::bottom:
      return others + font.descent() * size;
    case TextAnchor::middle:
      return (others - capital) / 2;
    case TextAnchor::top:
      return -capital;
  }
  return 0;
}

/// Capital letters are as high as the size of the block, or the font is as large as it.
double font_size(const TextBlock& block, const Letters& font) {
  return block.unit == TextUnit::capital ? block.size / font.capital() : block.size;
}

/// One line of a block at a place of its own.
struct PlacedLine {
  std::string text;
  double x = 0, y = 0;  ///< of its begin on the baseline
};

class TextDrawing {
 public:
  explicit TextDrawing(const Letters& font) : font_(font) {}

  TextCurves curves() && { return std::move(curves_); }

  /// Blocks of one line, each after the one before.
  void add_runs(const std::vector<TextBlock>& runs) {
    double width = 0;
    for (const TextBlock& run : runs) width += run.shift_x + width_of(run);
    double x = -runs.front().align * width;
    for (const TextBlock& run : runs) {
      x += run.shift_x;
      const double size = font_size(run, font_);
      add_line(run, {run.lines.front(), x, run.shift_y + first_baseline(run, 1, size, font_)});
      x += width_of(run);
    }
  }

  void add_block(const TextBlock& block) {
    const double size = font_size(block, font_);
    std::vector<std::string> lines;
    for (const std::string& line : block.lines) {
      const std::vector<std::string> parts = block.wrap_width > 0
                                                 ? wrapped(line, block.wrap_width / size, font_)
                                                 : std::vector<std::string>{line};
      lines.insert(lines.end(), parts.begin(), parts.end());
    }
    double y = first_baseline(block, lines.size(), size, font_);
    for (const std::string& line : lines) {
      const double width = font_.line(line).width * size;
      add_line(block, {line, -block.align * (block.fit_width > 0 ? block.fit_width : width), y});
      y -= block.line_step;
    }
  }

 private:
  double width_of(const TextBlock& run) const {
    return font_.line(run.lines.front()).width * font_size(run, font_);
  }

  void add_line(const TextBlock& block, const PlacedLine& line) {
    const double size = font_size(block, font_);
    const LetteredLine letters = font_.line(line.text);
    const double width = letters.width * size;
    const double wide = block.fit_width > 0 && width > 0 ? block.fit_width / width : 1;
    const double high = block.fits_height ? wide : 1;
    const geometry::Affine map = block.frame * geometry::moved(line.x, line.y * high, 0) *
                                 geometry::scaled(size * wide, size * high, 1);
    curves_.missing += letters.missing;
    if (!block.is_drawn) return;
    for (const model::Path& letter : letters.paths) {
      model::Path path = letter;
      for (model::Piece& piece : path.pieces) piece = transformed(std::move(piece), map);
      path.layer = block.layer;
      path.colour = block.colour;
      path.area = block.area;
      path.covers = block.covers;
      // Outlines of fonts cross and overlap where their strokes do.
      path.fill_rule = block.area != 0 ? model::FillRule::non_zero : model::FillRule::even_odd;
      curves_.paths.push_back(std::move(path));
    }
  }

  const Letters& font_;
  TextCurves curves_;
};

}  // namespace

TextCurves text_curves(const std::vector<TextBlock>& blocks, const Letters& font) {
  TextDrawing drawing(font);
  for (std::size_t i = 0; i < blocks.size();) {
    std::size_t end = i + 1;
    while (end < blocks.size() && blocks[end].follows) ++end;
    if (end == i + 1)
      drawing.add_block(blocks[i]);
    else
      drawing.add_runs({blocks.begin() + static_cast<std::ptrdiff_t>(i),
                        blocks.begin() + static_cast<std::ptrdiff_t>(end)});
    i = end;
  }
  return std::move(drawing).curves();
}

}  // namespace lamplock::lettering
