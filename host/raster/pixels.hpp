// Converts a picture to powers of a continuous laser.
//
// In:  grey values, the number of pixels to engrave, the powers of black and of the lightest grey.
// Out: one power per pixel; 0 for white and for what is transparent.
// Who: `lamplock raster`, before it makes rows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/model/bitmap.hpp"

namespace lamplock::raster {

/// Powers, 65535 = full, from the 2048 values that rows can have (shared/wire/runs.hpp). The lowest
/// row is first, each from the left.
struct Pixels {
  std::size_t columns = 0, rows = 0;
  std::vector<std::uint16_t> power;

  std::uint16_t at(std::size_t column, std::size_t row) const {
    return power[row * columns + column];
  }
};

/// From grey to power, which is linear: 0..1 of full power.
struct PowerRange {
  double lightest = 0;  ///< power of nearly white greys
  double black = 1;
  bool invert = false;  ///< power 0 for black instead of white
};

/// The power nearest to `power` (0..1) that a run can have.
std::uint16_t power_of_run(double power);

/// The whole picture with this number of columns and rows: each pixel is the mean of its area.
/// Throws Error(bad_input) for powers out of range or no pixels.
Pixels make_pixels(const model::Bitmap& bitmap, std::size_t columns, std::size_t rows,
                   const PowerRange& range);

}  // namespace lamplock::raster
