// The orientation of a picture in its Exif data.
//
// In:  a block of Exif, which is a TIFF header with a directory of tags. Out: a number from 1 to 8.
// Who: the readers of JPEG and PNG.
#pragma once

#include <string_view>

namespace lamplock::model {

/// 1 (upright) if the block has no orientation, or is damaged: it is not part of the picture.
int exif_orientation(std::string_view block);

}  // namespace lamplock::model
