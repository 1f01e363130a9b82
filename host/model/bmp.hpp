// Reads BMP.
//
// In:  the bytes of a BMP file. Out: its grey values and opacity, upright.
// Who: read_bitmap.cpp.
#pragma once

#include <filesystem>
#include <string>

#include "host/model/bitmap.hpp"

namespace lamplock::model {

bool is_bmp(const std::string& bytes);

/// Uncompressed pictures of Windows (every version of the header) and OS/2: 1, 2, 4 or 8 bits with
/// a palette; 16, 24 and 32 bits. Alpha is that of 32 bits, unless it is 0 everywhere. Throws
/// Error(bad_input) for compressed ones, for a file that is cut off or damaged, for a pixel whose
/// colour the palette does not have, and for more than max_pixels.
Bitmap decode_bmp(const std::filesystem::path& file, const std::string& bytes);

}  // namespace lamplock::model
