#include "host/points/weld.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "host/error.hpp"

namespace lamplock::points {
namespace {

constexpr std::uint32_t no_point = std::numeric_limits<std::uint32_t>::max();

/// Kept points by grid cell. Cells are hashed into buckets without storing the cell: two cells in
/// one bucket only cost a few more comparisons of distance, never a wrong answer.
class KeptPoints {
 public:
  KeptPoints(std::size_t point_count, double min_distance)
      : distance_(min_distance),
        heads_(std::bit_ceil(std::max<std::size_t>(point_count, 2)), no_point),
        next_(point_count, no_point) {}

  bool is_near(const geometry::PointCloud& kept, const geometry::Point& point) const {
    const Cell low = cell_of({point.x - distance_, point.y - distance_, point.z - distance_});
    const Cell high = cell_of({point.x + distance_, point.y + distance_, point.z + distance_});
    // Cells are two distances wide, so a ball of one distance touches at most two per axis.
    for (int corner = 0; corner < 8; ++corner) {
      Cell cell = low;
      bool repeated = false;
      for (int axis = 0; axis < 3; ++axis) {
        if ((corner >> axis & 1) == 0) continue;
        const auto a = static_cast<std::size_t>(axis);
        repeated = repeated || high[a] == low[a];
        cell[a] = high[a];
      }
      if (!repeated && bucket_has_near(kept, cell, point)) return true;
    }
    return false;
  }

  void add(std::uint32_t index, const geometry::Point& point) {
    std::uint32_t& head = heads_[bucket(cell_of(point))];
    next_[index] = head;
    head = index;
  }

 private:
  using Cell = std::array<std::int64_t, 3>;

  Cell cell_of(const geometry::Point& point) const {
    return {cell_index(point.x), cell_index(point.y), cell_index(point.z)};
  }

  std::int64_t cell_index(double coordinate) const {
    // Far outside any machine; prevents overflow of the conversion.
    constexpr double limit = 9e18;
    return static_cast<std::int64_t>(
        std::clamp(std::floor(coordinate / (2 * distance_)), -limit, limit));
  }

  std::size_t bucket(const Cell& cell) const {
    // Odd 64-bit constants of the golden ratio and of splitmix64 spread neighbouring cells.
    std::uint64_t hash = static_cast<std::uint64_t>(cell[0]) * 0x9E3779B97F4A7C15u;
    hash = (hash ^ (hash >> 29)) + static_cast<std::uint64_t>(cell[1]) * 0xBF58476D1CE4E5B9u;
    hash = (hash ^ (hash >> 31)) + static_cast<std::uint64_t>(cell[2]) * 0x94D049BB133111EBu;
    hash ^= hash >> 32;
    return static_cast<std::size_t>(hash) & (heads_.size() - 1);
  }

  bool bucket_has_near(const geometry::PointCloud& kept, const Cell& cell,
                       const geometry::Point& point) const {
    for (std::uint32_t i = heads_[bucket(cell)]; i != no_point; i = next_[i]) {
      const double dx = kept[i].x - point.x, dy = kept[i].y - point.y, dz = kept[i].z - point.z;
      if (dx * dx + dy * dy + dz * dz < distance_ * distance_) return true;
    }
    return false;
  }

  double distance_;
  std::vector<std::uint32_t> heads_, next_;
};

}  // namespace

WeldResult weld(geometry::PointCloud cloud, double min_distance_mm, std::size_t always_kept) {
  if (!(min_distance_mm >= 0) || !std::isfinite(min_distance_mm)) {
    throw Error(Exit::bad_input, "weld", fmt::format("distance {} mm", min_distance_mm),
                "give 0 or a positive distance");
  }
  if (min_distance_mm == 0) return {std::move(cloud), 0};
  if (cloud.size() >= no_point) {
    throw Error(Exit::bad_input, "weld", fmt::format("{} points", cloud.size()),
                "use a larger spacing");
  }
  KeptPoints grid(cloud.size(), min_distance_mm);
  WeldResult result;
  // The kept points move to the front of the same cloud: no second copy in memory.
  std::size_t count = 0, taken = 0;
  for (const geometry::Point& point : cloud) {
    if (taken++ >= always_kept && grid.is_near(cloud, point)) continue;
    grid.add(static_cast<std::uint32_t>(count), point);
    cloud[count++] = point;
  }
  result.removed = cloud.size() - count;
  cloud.resize(count);
  result.points = std::move(cloud);
  return result;
}

}  // namespace lamplock::points
