// Points by the cells of a grid, to find those near a place. In: points, one after the other. Out:
// the points within a reach. Called by weld(), spread_over_shells() and empty_surface().
//
// Cells are two reaches wide and hashed into buckets without storing the cell: two cells in one
// bucket only cost a few more comparisons of distance, never a wrong answer. A ball of one reach
// usually touches two cells per axis. At a coordinate near an odd multiple of the reach, rounding
// can put its ends two cells apart, so the search visits all cells between the ends.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "host/geometry/point.hpp"

namespace lamplock::points {

class PointGrid {
 public:
  /// The caller adds indices below `max_points` and searches within `reach_mm`, which is positive.
  PointGrid(std::size_t max_points, double reach_mm)
      : reach_(reach_mm),
        heads_(std::bit_ceil(std::max<std::size_t>(max_points, 2)), none),
        next_(max_points, none) {}

  /// The largest number of points.
  static constexpr std::size_t max_size = std::numeric_limits<std::uint32_t>::max();

  /// Adds a point with finite coordinates; each index once.
  void add(std::uint32_t index, const geometry::Point& point) {
    std::uint32_t& head = heads_[bucket(cell_of(point))];
    next_[index] = head;
    head = index;
  }

  /// Calls `found(index)` for every point within the reach, and for some others, until it returns
  /// true. Returns whether it did. An index may come more than once.
  ///
  /// A point counts as within the reach if the rounded square of its distance is below the rounded
  /// square of the reach: its cell is then between those of the ends, because rounding is
  /// monotonic.
  template <class Found>
  bool any_near(const geometry::Point& place, const Found& found) const {
    const Cell low = cell_of({place.x - reach_, place.y - reach_, place.z - reach_});
    const Cell high = cell_of({place.x + reach_, place.y + reach_, place.z + reach_});
    for (std::int64_t z = low[2]; z <= high[2]; ++z) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t x = low[0]; x <= high[0]; ++x) {
          for (std::uint32_t i = heads_[bucket({x, y, z})]; i != none; i = next_[i]) {
            if (found(i)) return true;
          }
        }
      }
    }
    return false;
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  Cell cell_of(const geometry::Point& point) const {
    return {cell_index(point.x), cell_index(point.y), cell_index(point.z)};
  }

  std::int64_t cell_index(double coordinate) const {
    // Far outside any machine; prevents overflow of the conversion.
    constexpr double limit = 9e18;
    return static_cast<std::int64_t>(
        std::clamp(std::floor(coordinate / (2 * reach_)), -limit, limit));
  }

  std::size_t bucket(const Cell& cell) const {
    // Odd 64-bit constants of the golden ratio and of splitmix64 spread neighbouring cells.
    std::uint64_t hash = static_cast<std::uint64_t>(cell[0]) * 0x9E3779B97F4A7C15u;
    hash = (hash ^ (hash >> 29)) + static_cast<std::uint64_t>(cell[1]) * 0xBF58476D1CE4E5B9u;
    hash = (hash ^ (hash >> 31)) + static_cast<std::uint64_t>(cell[2]) * 0x94D049BB133111EBu;
    hash ^= hash >> 32;
    return static_cast<std::size_t>(hash) & (heads_.size() - 1);
  }

  double reach_;
  std::vector<std::uint32_t> heads_, next_;
};

}  // namespace lamplock::points
