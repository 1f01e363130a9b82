// Places along a contour by their distance from its begin.
//
// In:  a contour, mm along it. Out: points and parts of it.
// Who: leads, tabs and the path of a cut.
#pragma once

#include <cstddef>
#include <vector>

#include "host/cutting/contour.hpp"

namespace lamplock::cutting {

struct ContourPoint {
  std::size_t edge = 0;
  double part = 0;  ///< of the length of the edge
};

/// The point at a distance along the contour; beyond the end of a closed one it runs around again,
/// beyond that of an open one it is the end. A joint of two edges is the end of the first one.
ContourPoint point_along(const Contour& contour, double along_mm);

/// The edges between two distances along the contour, from <= to; of a closed one `to` may be
/// beyond its length.
std::vector<Edge> edges_between(const Contour& contour, double from_mm, double to_mm);

}  // namespace lamplock::cutting
