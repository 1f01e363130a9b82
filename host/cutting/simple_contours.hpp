// Closed contours that cross themselves or each other, made simple.
//
// In:  closed contours of lines and arcs. Out: the boundary of their area, lines and arcs again.
// Who: offset(), whose exact way needs contours that cross nothing.
//
// The union of polygons with fine chords finds which parts of the contours remain; these are cut
// out of the lines and arcs themselves, at their exact intersections. Where that fails, because
// edges touch at a small angle, the chords remain, which are nowhere further than chords_mm away.
#pragma once

#include <cstddef>
#include <vector>

#include "host/cutting/contour.hpp"

namespace lamplock::cutting {

struct SimpleContours {
  std::vector<Contour> contours;
  std::vector<std::size_t> from;  ///< number of the contour with the longest part of each
};

/// The inside of a contour that crosses itself is what it runs around, in whatever direction; it
/// remains on the left if the signed area is not negative, otherwise on the right. Of several
/// contours, the area is that on the left: a hole takes away from a part, and parts are united. If
/// the largest of them has its inside on the right, all are holes in a sheet.
SimpleContours simple_contours(const std::vector<Contour>& contours);

}  // namespace lamplock::cutting
