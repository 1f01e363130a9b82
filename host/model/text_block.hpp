// Text of a drawing before its letters are curves.
//
// In:  text entities of a file. Out: lines of text with the place of each.
// Who: the readers of drawings; text_curves(), which draws the letters.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/model/curves.hpp"

namespace lamplock::model {

/// What a height of 1 is in the coordinates of a text.
enum class TextUnit : std::uint8_t {
  capital,  ///< height of a capital letter (DXF)
  em        ///< font size (SVG)
};

/// The height of the block that is at y = 0.
enum class TextAnchor : std::uint8_t { baseline, bottom, middle, top };

/// Lines of text in coordinates of their own: x along the line, y upwards, the place in the origin.
struct TextBlock {
  std::vector<std::string> lines;  ///< UTF-8
  geometry::Affine frame;          ///< to mm
  TextUnit unit = TextUnit::capital;
  double size = 1;   ///< height of the letters
  double align = 0;  ///< part of each line that is left of the origin, 0..1
  TextAnchor anchor = TextAnchor::baseline;
  double line_step = 0;      ///< between baselines
  double wrap_width = 0;     ///< lines are broken at blanks; 0: never
  double fit_width = 0;      ///< the line is stretched to it; 0: not
  bool fits_height = false;  ///< the height changes with the stretched width
  /// Continues the line of the block before, which has one line: from its end, moved by this.
  bool follows = false;
  double shift_x = 0, shift_y = 0;
  bool is_drawn = true;     ///< false: it only needs room in its line
  bool is_filled = false;   ///< an area, not a line
  bool covers = false;      ///< as of paths
  std::uint32_t area = 0;   ///< as of paths, of all letters of the block
  std::uint32_t layer = 0;  ///< as of paths
  Colour colour = no_colour;
};

/// A drawing with its texts.
struct LetteredDrawing {
  Curves curves;  ///< none of a drawing of texts alone
  std::vector<TextBlock> texts;
  std::size_t hatches = 0;     ///< areas of a DXF whose outlines are among the curves
  std::string unknown_unit{};  ///< number of a DXF ($INSUNITS) that is no unit; its numbers are mm
};

}  // namespace lamplock::model
