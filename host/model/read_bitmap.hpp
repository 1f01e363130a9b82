// Reads bitmaps.
//
// In:  a PNG, BMP or JPEG file. Out: its grey values and opacity, upright.
// Who: the use cases before the picture becomes points or rows; pictures of meshes.
//
// The content of a file says what it is, not its extension.
#pragma once

#include <filesystem>
#include <string>

#include "host/model/bitmap.hpp"

namespace lamplock::model {

/// Colours become their luma; orientations of Exif are applied. Throws Error(bad_input) for a file
/// that is missing, damaged, truncated or larger than 100 million pixels, and for another format;
/// if it is a known one, the error names it.
Bitmap read_bitmap(const std::filesystem::path& path);

/// The same for a picture inside another file; `path` names it in errors.
Bitmap decode_bitmap(const std::filesystem::path& path, const std::string& bytes);

/// True for the extension of a format of pictures that is known and not read, as .gif.
bool is_foreign_picture(const std::string& extension);

}  // namespace lamplock::model
