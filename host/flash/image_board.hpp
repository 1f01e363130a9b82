// The board that an image is for.
//
// In:  an image. Out: the name of its board (BoardRow::name), from its binary info
// (shared/wire/binary_info.hpp). Who: `flash`, so that an image does not run on another board.
#pragma once

#include <string>

#include "host/flash/flash_image.hpp"

namespace lamplock::flash {

/// Empty for images of other programs and for images without the name of their board.
std::string board_of_image(const FlashImage& image);

}  // namespace lamplock::flash
