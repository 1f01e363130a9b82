// Reads PNG.
//
// In:  the bytes of a PNG file. Out: its grey values and opacity, upright.
// Who: read_bitmap.cpp.
#pragma once

#include <filesystem>
#include <string>

#include "host/model/bitmap.hpp"

namespace lamplock::model {

bool is_png(const std::string& bytes);

/// Every colour type and depth; 16 bits are rounded to 8. Transparency is that of an alpha channel,
/// a palette or a transparent colour; the orientation is that of an eXIf chunk. Throws
/// Error(bad_input) if the checksum of a chunk is wrong, for a file that is cut off or has more
/// bytes after its end, for one that the library refuses, and for more than max_pixels.
Bitmap decode_png(const std::filesystem::path& file, const std::string& bytes);

}  // namespace lamplock::model
