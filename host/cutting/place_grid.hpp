// Places by square cells, so that those near a place are found at once.
//
// In:  numbered places. Out: the numbers near another place.
// Who: joining of contours and of the pieces of offset contours.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "host/cutting/edge.hpp"

namespace lamplock::cutting {

/// Groups numbers by places, so that those near a place are found at once.
class PlaceGrid {
 public:
  explicit PlaceGrid(double cell_mm) : cell_(cell_mm) {}
  void add(const Vec& at, std::size_t number) {
    cells_[key(cell(at.x), cell(at.y))].push_back(number);
  }
  /// Calls found(number) for all places within a cell's width of `at`, and some that are further.
  template <class Found>
  void visit(const Vec& at, const Found& found) const {
    for (std::int64_t x = cell(at.x) - 1; x <= cell(at.x) + 1; ++x) {
      for (std::int64_t y = cell(at.y) - 1; y <= cell(at.y) + 1; ++y) {
        const auto entry = cells_.find(key(x, y));
        if (entry == cells_.end()) continue;
        for (const std::size_t number : entry->second) found(number);
      }
    }
  }

 private:
  std::int64_t cell(double x) const { return std::llround(std::floor(x / cell_)); }
  static std::uint64_t key(std::int64_t x, std::int64_t y) {
    constexpr std::uint64_t odd = 0x9E3779B97F4A7C15u;  // spreads the bits; splitmix64
    return static_cast<std::uint64_t>(x) * odd + static_cast<std::uint64_t>(y);
  }
  double cell_;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> cells_;
};

}  // namespace lamplock::cutting
