// Groups of contours that are near each other.
//
// In:  contours. Out: groups, such that contours of different groups are far from each other.
// Who: offset(), which computes each group by itself.
#pragma once

#include <cstddef>
#include <vector>

#include "host/cutting/contour.hpp"

namespace lamplock::cutting {

/// The numbers of the contours of each group in order; groups in the order of their first contour.
/// Edges of contours of different groups are further apart than `reach_mm`; those of one group may
/// be, too.
std::vector<std::vector<std::size_t>> contour_groups(const std::vector<Contour>& contours,
                                                     double reach_mm);

}  // namespace lamplock::cutting
