// Sets of numbers that are joined.
//
// In:  pairs of numbers that belong together. Out: the sets.
// Who: groups of contours that are near each other or cross each other, parts of meshes, flat
// places.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace lamplock::geometry {

/// Tarjan, "Efficiency of a good but not linear set union algorithm", Journal of the ACM 22, 1975;
/// with halved paths; the lowest number represents a set. For fewer than 2^32 numbers.
class UnionFind {
 public:
  explicit UnionFind(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::uint32_t{0});
  }
  std::uint32_t find(std::size_t number) {
    auto i = static_cast<std::uint32_t>(number);
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t i, std::size_t j) {
    i = find(i);
    j = find(j);
    parent_[std::max(i, j)] = static_cast<std::uint32_t>(std::min(i, j));
  }
  /// The numbers of each set in order; sets in the order of their lowest number.
  std::vector<std::vector<std::size_t>> sets() {
    std::vector<std::vector<std::size_t>> sets;
    std::vector<std::size_t> place(parent_.size());
    for (std::size_t i = 0; i < parent_.size(); ++i) {
      const std::size_t first = find(i);
      if (first == i) {
        place[i] = sets.size();
        sets.emplace_back();
      }
      sets[place[first]].push_back(i);
    }
    return sets;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace lamplock::geometry
