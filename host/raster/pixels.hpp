// A picture as powers of a continuous laser.
//
// In:  grey values, how many pixels to burn, what black and the lightest grey are worth.
// Out: one power a pixel. White stays dark.
// Who: `lamplock raster`, before rows are made of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/model/bitmap.hpp"

namespace lamplock::raster {

/// Powers, 65535 = full: those of the 2048 that rows can have (shared/wire/runs.hpp). The lowest
/// row comes first, each from the left.
struct Pixels {
  std::size_t columns = 0, rows = 0;
  std::vector<std::uint16_t> power;

  std::uint16_t at(std::size_t column, std::size_t row) const {
    return power[row * columns + column];
  }
};

/// From grey to power, which is linear: 0..1 of full power.
struct PowerRange {
  double lightest = 0;  ///< what greys come to that are nearly white
  double black = 1;
  bool invert = false;  ///< black stays dark instead
};

/// The power next to `power` (0..1) that a run can have.
std::uint16_t power_of_run(double power);

/// The whole picture in so many columns and rows: each pixel is the mean of what it covers. Throws
/// Error(bad_input) for powers out of range or no pixels.
Pixels make_pixels(const model::Bitmap& bitmap, std::size_t columns, std::size_t rows,
                   const PowerRange& range);

}  // namespace lamplock::raster
