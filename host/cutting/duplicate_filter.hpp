// Contours that are drawn twice.
//
// In:  contours with their layers. Out: those that remain, and a fault for each of the others.
// Who: join_contours().
#pragma once

#include <cstddef>
#include <vector>

#include "host/cutting/contour.hpp"

namespace lamplock::cutting {

/// Removes contours that are the same as an earlier one of their group of layers, wherever they
/// begin and in whatever direction they run.
class DuplicateFilter {
 public:
  /// `groups`: as in JoinOptions.
  DuplicateFilter(double tolerance_mm, const std::vector<std::size_t>& groups,
                  std::vector<Fault>& faults)
      : tolerance_(tolerance_mm), groups_(groups), faults_(faults) {}

  /// The numbers of the contours that remain, in order.
  std::vector<std::size_t> keep(const std::vector<Contour>& contours);

 private:
  // Without a meaning for drawings.
  static constexpr double part_of_corner = 0.618;

  bool is_same(const Contour& a, const Box& box_a, const Contour& b, const Box& box_b) const;
  std::size_t group(const Contour& contour) const {
    return groups_.empty() ? contour.layer : groups_[contour.layer];
  }

  double tolerance_;
  const std::vector<std::size_t>& groups_;
  std::vector<Fault>& faults_;
};

}  // namespace lamplock::cutting
