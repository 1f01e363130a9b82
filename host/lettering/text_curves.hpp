// Texts of a drawing as curves of letters.
//
// In:  blocks of text with their places, letters. Out: curves in mm.
// Who: the use case of cutting.
#pragma once

#include <cstddef>
#include <vector>

#include "host/lettering/letters.hpp"
#include "host/model/text_block.hpp"

namespace lamplock::lettering {

struct TextCurves {
  std::vector<model::Path> paths;  ///< with the layers and the colours of the blocks
  std::size_t missing = 0;         ///< letters that there are not
};

TextCurves text_curves(const std::vector<model::TextBlock>& blocks, const Letters& letters);

}  // namespace lamplock::lettering
