// Points of a job for pages: a sample to draw, and the exact points near a line of sight.
//
// In:  the points of a job, in firing order. Out: bytes for the graphics card of a page; points
//      with their numbers.
// Who: the methods cloud.open, cloud.points and cloud.near.
//
// A page cannot hold and draw any number of points, so it gets at most max_shown. They come in a
// random order, the same each time: any first part of them is an even sample of the cloud.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "host/geometry/bounds.hpp"
#include "host/geometry/point.hpp"

namespace lamplock::serve {

/// A line of sight: a place on it, mm, and its direction, of any length but 0.
struct Sight {
  geometry::Point at, along;
};

struct NearPoint {
  std::size_t number = 0;  ///< in firing order, from 0
  double distance_mm = 0;  ///< from the line of sight
  geometry::Point place;   ///< mm
};

class Cloud {
 public:
  static constexpr std::size_t bytes_per_point = 8;
  static constexpr std::size_t max_shown = 262'144;  ///< points that a page gets: 2 MiB
  static constexpr std::size_t max_part = 65'536;    ///< of them in one frame: 512 KiB
  static constexpr std::size_t max_near = 400;       ///< some 30 KB as text in an answer

  explicit Cloud(geometry::PointCloud points);

  std::size_t size() const { return points_.size(); }
  std::size_t shown() const { return sample_.size(); }
  const geometry::Bounds& bounds() const { return bounds_; }
  /// The shown points from this one on, at most max_part: for each four 16-bit numbers, little
  /// endian: x, y and z from 0 to 65535 in the bounds, and the same for its place in the order.
  std::string part(std::size_t from) const;
  /// The points at most this far from the line of sight, nearest first, at most max_near.
  std::vector<NearPoint> near(const Sight& sight, double mm) const;

 private:
  geometry::PointCloud points_;
  geometry::Bounds bounds_;
  std::vector<std::uint32_t> sample_;  ///< numbers of the shown points
};

}  // namespace lamplock::serve
