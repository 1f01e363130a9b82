// Raw offset edges: every line, arc and corner of contours moved aside by itself.
//
// In:  contours, the distance. Out: edges that contain all points of the offset, and more.
// Who: offset().
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "host/cutting/offset.hpp"

namespace lamplock::cutting {

struct RawEdge {
  Edge edge;
  std::size_t contour = 0;
  /// Place along the contour: 2 i for edge i, 2 i + 1 for the corner after it.
  std::size_t place = 0;
};

/// The area that a mitre adds to an arc: corner, end of the first edge, tip, start of the second.
struct Mitre {
  std::array<Vec, 4> corners;
  /// True if the point is inside by more than `slack_mm`.
  bool contains(const Vec& point, double slack_mm) const;
};

struct RawOffset {
  std::vector<RawEdge> edges;
  std::vector<Mitre> mitres;
};

/// To the right of all contours by options.distance_mm, which is positive.
RawOffset raw_offset(const std::vector<Contour>& contours, const OffsetOptions& options);

}  // namespace lamplock::cutting
