// Pieces of raw offset edges that are part of the offset.
//
// In:  contours and their raw offset edges. Out: the parts of these between intersections that have
//      the distance from all contours.
// Who: offset().
#pragma once

#include <cstddef>
#include <vector>

#include "host/cutting/contour.hpp"
#include "host/cutting/raw_offset.hpp"

namespace lamplock::cutting {

// Intersections this near to an end of an edge are that end, pieces this short are nothing, and a
// piece may be nearer to the contours by this; a hundredth of what a fine positioner repeats to.
inline constexpr double offset_end_mm = 1e-7;

/// A part of a raw edge.
struct OffsetPiece {
  Edge edge;
  std::size_t raw;
  double begin, end;  ///< parts of the length of the raw edge
  bool is_gone = false;
};

/// Where a piece ends it meets others, to a few offset_end_mm; some that are short may have no
/// others.
std::vector<OffsetPiece> pieces_at_distance(const std::vector<Contour>& contours,
                                            const RawOffset& raw, double distance_mm);

}  // namespace lamplock::cutting
