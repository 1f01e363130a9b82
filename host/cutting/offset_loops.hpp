// Loops and chains of pieces of raw offset edges.
//
// In:  the pieces at the distance from all contours. Out: the offset contours, and where the beam
//      does not fit.
// Who: offset().
#pragma once

#include <vector>

#include "host/cutting/offset.hpp"
#include "host/cutting/offset_pieces.hpp"

namespace lamplock::cutting {

/// `width_mm` is that of the beam, for the report of narrow places.
OffsetContours loops_of(const std::vector<Contour>& contours, const std::vector<RawEdge>& raw,
                        std::vector<OffsetPiece> pieces, double width_mm);

}  // namespace lamplock::cutting
