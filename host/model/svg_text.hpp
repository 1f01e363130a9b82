// Text elements of an SVG (W3C, "Scalable Vector Graphics (SVG) 2", chapter 11).
//
// In:  a text element. Out: its runs of characters with their places, in px of the user.
// Who: read_svg_with_texts().
#pragma once

#include <pugixml.hpp>
#include <string>
#include <vector>

#include "host/model/svg_document.hpp"
#include "host/model/svg_paint.hpp"
#include "host/model/text_block.hpp"

namespace lamplock::model {

struct SvgText {
  std::vector<TextBlock> runs;
  std::vector<std::string> left_out;  ///< names of elements in it that are not read
};

/// `units` and `paint` are those of the element itself. Throws Error (bad_input) for places that
/// are not lengths.
SvgText svg_text(const pugi::xml_node& text, const SvgUnits& units, const SvgPaint& paint,
                 const SvgDocument& document);

}  // namespace lamplock::model
