// Contours that are drawn twice.
//
// In:  contours with their layers. Out: those that remain, and a fault for each of the others.
// Who: join_contours().
#pragma once

#include <cstddef>
#include <vector>

#include "host/cutting/contour.hpp"

namespace lamplock::cutting {

/// Removes contours that are the same as an earlier one of their group of layers, in whatever
/// direction they run; closed ones wherever they begin. Both must be near each other all along, and
/// open ones at their ends: by the tolerance, the width of a beam, or a part of their length,
/// whichever is the smallest.
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

  struct Size {
    Box box;
    double near_mm;  ///< what is nearer than this may be the same
  };

  bool is_same(const Contour& a, const Size& size_a, const Contour& b, const Size& size_b) const;
  std::size_t group(const Contour& contour) const {
    return groups_.empty() ? contour.layer : groups_[contour.layer];
  }

  double tolerance_;
  const std::vector<std::size_t>& groups_;
  std::vector<Fault>& faults_;
};

}  // namespace lamplock::cutting
