// Points of a picture round the origin.
#pragma once

#include "host/points/bitmap_points.hpp"

namespace lamplock::test {

/// The points of a picture with this longest side.
inline geometry::PointCloud picture_points(const model::Bitmap& bitmap, double size_mm,
                                           const points::BitmapOptions& options,
                                           points::Plane plane = points::Plane::xy) {
  return points::bitmap_points(bitmap, points::picture_frame(bitmap, size_mm, plane), options)
      .points;
}

}  // namespace lamplock::test
