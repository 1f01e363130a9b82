// Points in parallel layers, layer by layer. Out of slice(); drawings and bitmaps in several layers
// have them too. Called by the host's run/keep_apart.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "host/geometry/point.hpp"

namespace lamplock::points {

struct LayeredPoints {
  geometry::PointCloud points{};
  std::vector<std::size_t> first{};  ///< index of the first point of each layer, ascending

  std::span<const geometry::Point> layer(std::size_t i) const {
    const std::size_t end = i + 1 < first.size() ? first[i + 1] : points.size();
    return std::span(points).subspan(first[i], end - first[i]);
  }
};

}  // namespace lamplock::points
