// Colours and paints of SVG (W3C, "CSS Color Module Level 4"; "Scalable Vector Graphics (SVG) 2",
// chapter 13).
//
// In:  the text of a colour, of the properties fill and stroke. Out: what of it decides if a mark
//      is visible.
// Who: the paint of read_svg(), the cascade of its styles.
#pragma once

#include <optional>
#include <string_view>

namespace lamplock::model {

struct SvgColour {
  bool is_white = false;  ///< as the page, fully opaque
  double alpha = 1;
};

/// A colour in any form: hexadecimal, a name, a function such as rgb() and hsl(). Empty for other
/// text. Functions of other colour spaces are never white.
std::optional<SvgColour> find_svg_colour(std::string_view text);

/// True for a valid value of fill and stroke, except the keywords that all properties have.
bool is_svg_paint(std::string_view text);

}  // namespace lamplock::model
