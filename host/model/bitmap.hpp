// A bitmap: grey values of a picture.
#pragma once

#include <cstdint>
#include <vector>

namespace lamplock::model {

/// Row by row from the top left; 0 black, 255 white.
struct Bitmap {
  int width = 0, height = 0;
  std::vector<std::uint8_t> grey;
};

}  // namespace lamplock::model
