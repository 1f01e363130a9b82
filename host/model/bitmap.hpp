// Bitmaps. Comes in: a PNG, BMP or JPEG file. Goes out: its grey values. Called by the command line
// before bitmap_points().
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace lamplock::model {

/// Row by row from the top left; 0 black, 255 white.
struct Bitmap {
  int width = 0, height = 0;
  std::vector<std::uint8_t> grey;
};

/// Colours become their luma, transparent pixels are laid over white; a turn that a
/// camera noted (EXIF) is not made. Throws Error (bad_input) for
/// a file that is missing, damaged, truncated, of another format or larger than 100 million pixels.
Bitmap read_bitmap(const std::filesystem::path& path);

/// The same for a picture inside another file; `path` names it in errors.
Bitmap decode_bitmap(const std::filesystem::path& path, const std::string& bytes);

}  // namespace lamplock::model
