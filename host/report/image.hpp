// A picture in linear light: three floats a pixel.
#pragma once

#include <algorithm>
#include <cstddef>
#include <thread>
#include <vector>

#include "host/report/camera.hpp"

namespace lamplock::report {

struct Image {
  Image(int w, int h)
      : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  Vec& at(int x, int y) { return pixels[index(x, y)]; }
  const Vec& at(int x, int y) const { return pixels[index(x, y)]; }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
  int width, height;
  std::vector<Vec> pixels;
};

/// Perceived brightness of linear light (ITU-R BT.709).
inline float luminance(Vec c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

/// Calls paint(row) for every row 0..rows-1, on several threads.
template <class Paint>
void for_rows(int rows, unsigned threads, const Paint& paint) {
  const int count = std::clamp(static_cast<int>(threads), 1, std::max(1, rows));
  std::vector<std::jthread> workers;
  workers.reserve(static_cast<std::size_t>(count));
  for (int t = 0; t < count; ++t)
    workers.emplace_back([=, &paint] {
      for (int row = t; row < rows; row += count) paint(row);
    });
}

}  // namespace lamplock::report
