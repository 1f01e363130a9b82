// Random pictures of pixels. Who: tests of rows.
#pragma once

#include <cstdint>
#include <random>

#include "host/raster/pixels.hpp"

namespace lamplock::test {

/// Runs of equal neighbours, many dark, some rows blank; at least one pixel is lit.
inline raster::Pixels random_pixels(std::size_t columns, std::size_t rows, std::mt19937_64& random,
                                    std::size_t max_run = 30) {
  raster::Pixels pixels{columns, rows, std::vector<std::uint16_t>(columns * rows)};
  for (std::size_t row = 0; row < rows; ++row) {
    if (random() % 5 == 0) continue;
    for (std::size_t column = 0; column < columns;) {
      const std::size_t end = std::min(columns, column + 1 + random() % max_run);
      const double level = static_cast<double>(random() % 1000) / 999;
      const std::uint16_t power =
          random() % 2 == 0 ? std::uint16_t{0} : raster::power_of_run(level);
      for (; column < end; ++column) pixels.power[row * columns + column] = power;
    }
  }
  pixels.power[random() % pixels.power.size()] = raster::power_of_run(1);
  return pixels;
}

}  // namespace lamplock::test
