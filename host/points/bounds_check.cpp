#include "host/points/bounds_check.hpp"

#include <fmt/format.h>

#include "host/error.hpp"
#include "host/number_text.hpp"

namespace lamplock::points {
namespace {

/// By the rounding of scaled coordinates, mm; far below a step.
geometry::Bounds widened(const geometry::Bounds& box) {
  constexpr double by = 1e-6;
  return {{box.low.x - by, box.low.y - by, box.low.z - by},
          {box.high.x + by, box.high.y + by, box.high.z + by}};
}

}  // namespace

void check_bounds(std::span<const geometry::Point> cloud, const geometry::Bounds& room,
                  const std::string& where, const std::string& place) {
  const geometry::Bounds allowed = widened(room);
  std::size_t bad = 0, first = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    // contains() is false for NaN, so one test serves both.
    if (allowed.contains(cloud[i]) && geometry::is_finite(cloud[i])) continue;
    if (bad++ == 0) first = i;
  }
  if (bad == 0) return;
  const geometry::Point& point = cloud[first];
  const geometry::Point &low = room.low, &high = room.high;
  throw Error(
      Exit::bad_input, where,
      fmt::format("{} of {} {}, the first is point {} at ({:.6g}, {:.6g}, {:.6g}) mm", grouped(bad),
                  count_text(cloud.size(), "point"),
                  geometry::is_finite(point) ? (bad == 1 ? "lies outside " : "lie outside ") + place
                  : bad == 1                 ? "is not finite or outside"
                                             : "are not finite or outside",
                  first, point.x, point.y, point.z),
      fmt::format("make the object fit x {:g}..{:g}, y {:g}..{:g}, z {:g}..{:g} mm", low.x, high.x,
                  low.y, high.y, low.z, high.z));
}

}  // namespace lamplock::points
