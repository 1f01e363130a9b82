// Reads JPEG.
//
// In:  the bytes of a JPEG file. Out: its grey values, upright.
// Who: read_bitmap.cpp.
#pragma once

#include <filesystem>
#include <string>

#include "host/model/bitmap.hpp"

namespace lamplock::model {

bool is_jpeg(const std::string& bytes);

/// Baseline and progressive, grey, colour and CMYK (inverted, as programs of Adobe and libjpeg
/// write it); the orientation is that of Exif. Throws Error(bad_input) for a file that is damaged
/// or cut off, for other kinds of JPEG, and for more than max_pixels.
Bitmap decode_jpeg(const std::filesystem::path& file, const std::string& bytes);

}  // namespace lamplock::model
