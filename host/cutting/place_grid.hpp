// Places by square cells, so that those near a place are found at once.
//
// In:  numbered places. Out: the numbers near another place.
// Who: joining of contours and of the pieces of offset contours.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/cutting/edge.hpp"

namespace lamplock::cutting {

/// Finds places within a distance that is known beforehand. Cells are entries of a hash table, so
/// that a drawing may have any extent; places of a cell are a list, and each of them is with its
/// coordinates in one array, because the time of a search is that of reading from memory.
class PlaceGrid {
 public:
  /// For up to about `count` places; more only make it slower.
  PlaceGrid(double reach_mm, std::size_t count)
      : reach_(reach_mm), cells_per_mm_(1 / (cell_in_reaches * reach_mm)) {
    while ((std::size_t{1} << bits_) < count) ++bits_;
    heads_.assign(std::size_t{1} << bits_, none);
    entries_.reserve(count);
  }

  void add(const Vec& at, std::size_t number) {
    std::uint32_t& head = heads_[slot(cell(at.x), cell(at.y))];
    entries_.push_back({at, static_cast<std::uint32_t>(number), head});
    head = static_cast<std::uint32_t>(entries_.size() - 1);
  }

  /// True if test(number) is true for a place that differs from `at` by at most the reach in each
  /// coordinate. Ends at the first; later places come first.
  template <class Test>
  bool any(const Vec& at, const Test& test) const {
    const double low_x = cell(at.x - reach_), high_x = cell(at.x + reach_);
    const double low_y = cell(at.y - reach_), high_y = cell(at.y + reach_);
    if (any_in_cell(low_x, low_y, at, test)) return true;
    if (high_x != low_x && any_in_cell(high_x, low_y, at, test)) return true;
    if (high_y == low_y) return false;
    return any_in_cell(low_x, high_y, at, test) ||
           (high_x != low_x && any_in_cell(high_x, high_y, at, test));
  }

  /// Calls found(number) for all these places.
  template <class Found>
  void visit(const Vec& at, const Found& found) const {
    any(at, [&](std::size_t number) {
      found(number);
      return false;
    });
  }

 private:
  // Larger cells have more places that are too far, smaller ones are more to be searched.
  static constexpr double cell_in_reaches = 4;
  static constexpr std::uint32_t none = 0xFFFFFFFF;

  struct Entry {
    Vec at;
    std::uint32_t number, next;
  };

  /// A whole number. 0 is added because -0 has other bits.
  double cell(double x) const { return std::floor(x * cells_per_mm_) + 0.0; }
  std::size_t slot(double x, double y) const {
    // Factors of splitmix64 and xxHash, which spread the bits.
    constexpr std::uint64_t odd = 0x9E3779B97F4A7C15u, other = 0xC2B2AE3D27D4EB4Fu;
    std::uint64_t key =
        std::bit_cast<std::uint64_t>(x) * odd + std::bit_cast<std::uint64_t>(y) * other;
    key ^= key >> 32;
    return static_cast<std::size_t>((key * odd) >> (64 - bits_));
  }

  template <class Test>
  bool any_in_cell(double x, double y, const Vec& at, const Test& test) const {
    for (std::uint32_t i = heads_[slot(x, y)]; i != none; i = entries_[i].next) {
      const Entry& entry = entries_[i];
      if (std::abs(entry.at.x - at.x) > reach_ || std::abs(entry.at.y - at.y) > reach_) continue;
      // Places of several cells share a slot; each is found in its own cell alone.
      if (cell(entry.at.x) != x || cell(entry.at.y) != y) continue;
      if (test(static_cast<std::size_t>(entry.number))) return true;
    }
    return false;
  }

  double reach_, cells_per_mm_;
  int bits_ = 1;  ///< of the number of a slot
  std::vector<std::uint32_t> heads_;
  std::vector<Entry> entries_;
};

}  // namespace lamplock::cutting
