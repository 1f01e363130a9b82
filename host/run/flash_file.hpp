// The image that `flash` writes: a UF2 file, or the ELF file that it was made from.
//
// In:  a file, or nothing. Out: a checked image. Who: `flash`.
#pragma once

#include <string>

#include "host/flash/flash_image.hpp"

namespace lamplock::run {

/// An image and where it came from.
struct FlashFile {
  std::string file;
  flash::FlashImage image;
  std::string board;  ///< board of the image; empty: unknown
};

/// Without a name: the image of that board that came with the program. Throws Error(bad_input).
FlashFile read_flash_file(const std::string& name, const std::string& board);

}  // namespace lamplock::run
