#include "host/points/weld.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <span>
#include <utility>

#include "host/error.hpp"
#include "host/geometry/vector.hpp"
#include "host/points/point_grid.hpp"

namespace lamplock::points {

WeldResult weld(geometry::PointCloud cloud, double min_distance_mm, std::size_t always_kept) {
  if (!(min_distance_mm >= 0) || !std::isfinite(min_distance_mm)) {
    throw Error(Exit::bad_input, "weld", fmt::format("distance {} mm", min_distance_mm),
                "give 0 or a positive distance");
  }
  if (min_distance_mm == 0) return {std::move(cloud), 0};
  if (cloud.size() >= PointGrid::max_size) {
    throw Error(Exit::bad_input, "weld", fmt::format("{} points", cloud.size()),
                "use a larger spacing");
  }
  PointGrid grid(cloud.size(), min_distance_mm);
  WeldResult result;
  // The kept points move to the front of the same cloud: no second copy in memory.
  std::size_t count = 0, taken = 0;
  for (const geometry::Point& point : cloud) {
    const auto is_near = [&](std::uint32_t i) {
      return square_of_distance(cloud[i], point) < min_distance_mm * min_distance_mm;
    };
    if (taken++ >= always_kept && grid.any_near(point, is_near)) continue;
    grid.add(static_cast<std::uint32_t>(count), point);
    cloud[count++] = point;
  }
  result.removed = cloud.size() - count;
  cloud.resize(count);
  result.points = std::move(cloud);
  return result;
}

WeldResult weld_in_layers(const LayeredPoints& cloud, double min_distance_mm) {
  WeldResult result;
  result.points.reserve(cloud.points.size());
  for (std::size_t i = 0; i < cloud.first.size(); ++i) {
    const std::span<const geometry::Point> layer = cloud.layer(i);
    const WeldResult welded = weld({layer.begin(), layer.end()}, min_distance_mm);
    result.points.insert(result.points.end(), welded.points.begin(), welded.points.end());
    result.removed += welded.removed;
  }
  return result;
}

}  // namespace lamplock::points
