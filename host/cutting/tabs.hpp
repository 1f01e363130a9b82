// Tabs: places of a cut that are not cut through, so that the part stays in the sheet.
//
// In:  a contour as it is cut, number and width of the tabs. Out: where they are.
// Who: cut_path().
#pragma once

#include <vector>

#include "host/cutting/contour.hpp"

namespace lamplock::cutting {

struct TabOptions {
  int count = 0;
  double width_mm = 0;            ///< of the material that remains
  double power = 0;               ///< in the tab, in parts of that of the cut, 0..1
  double corner_distance_mm = 0;  ///< between a tab and corners, begin and end of the contour
  double kerf_mm = 0;  ///< width of the beam or tool; arcs of half of it are corners, too
};

/// Where the beam is off, or the tool lifted, along the contour. The beam removes half the kerf
/// beyond both ends of the cut, so this way is longer than the tab by the kerf.
struct Tab {
  double begin_mm = 0, end_mm = 0;
};

/// Length of the way of a tab.
inline double way_mm(const TabOptions& options) { return options.width_mm + options.kerf_mm; }

/// Directions differ by more than this at a corner.
inline constexpr double min_corner_deg = 15;

/// Tabs in order, as evenly as the corners allow, at least one way apart from each other, and
/// none in the first `skipped_mm`, which are cut twice. A tab is whole between two corners. Throws
/// Error (bad_input) if they do not fit, for a width that is not positive, a power that is not
/// 0..1, a negative count, distance or kerf.
std::vector<Tab> tabs_of(const Contour& contour, const TabOptions& options, double skipped_mm = 0);

}  // namespace lamplock::cutting
