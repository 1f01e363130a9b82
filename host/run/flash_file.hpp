// The image that `flash` writes: a UF2 file, or the ELF file that it was made from.
//
// In:  a file, or nothing. Out: a checked image, the board that an image is for. Who: `flash`,
//      make_board().
#pragma once

#include <string>

#include "host/flash/flash_image.hpp"
#include "sim/chip/image/image.hpp"

namespace lamplock::run {

/// An image and where it came from.
struct FlashFile {
  std::string file;
  flash::FlashImage image;
  std::string board;  ///< board of the image; empty: unknown
};

/// The name of the board that an image is for; empty: unknown. Throws Error(bad_input).
std::string board_of_image(const sim::chip::Image& image, const std::string& file);

/// Without a name: the image of that board that came with the program. Throws Error(bad_input).
FlashFile read_flash_file(const std::string& name, const std::string& board);

}  // namespace lamplock::run
