// Texts of a drawing as outlines of letters.
//
// In:  blocks of text with their places, a font. Out: closed curves in mm.
// Who: the use case of cutting.
#pragma once

#include <cstddef>
#include <vector>

#include "host/lettering/font.hpp"
#include "host/model/text_block.hpp"

namespace lamplock::lettering {

struct TextCurves {
  std::vector<model::Path> paths;  ///< with the layers and the colours of the blocks
  std::size_t missing = 0;         ///< letters that the font does not have
};

TextCurves text_curves(const std::vector<model::TextBlock>& blocks, const Font& font);

}  // namespace lamplock::lettering
