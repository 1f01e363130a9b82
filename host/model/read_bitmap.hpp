// Reads bitmaps.
//
// In:  a PNG, BMP or JPEG file. Out: its grey values.
// Who: the command line before bitmap_points(); pictures of meshes.
#pragma once

#include <filesystem>
#include <string>

#include "host/model/bitmap.hpp"

namespace lamplock::model {

/// Colours become their luma, transparent pixels are laid over white; a rotation by EXIF is not
/// applied. Throws Error(bad_input) for a file that is missing, damaged, truncated, of another
/// format or larger than 100 million pixels.
Bitmap read_bitmap(const std::filesystem::path& path);

/// The same for a picture inside another file; `path` names it in errors.
Bitmap decode_bitmap(const std::filesystem::path& path, const std::string& bytes);

}  // namespace lamplock::model
