// Parallel lines that fill closed contours.
//
// In:  closed contours, distance and angle of the lines. Out: rows of pieces inside of them.
// Who: plan_cuts(), for engravings.
#pragma once

#include <vector>

#include "host/cutting/contour.hpp"

namespace lamplock::cutting {

/// One line: where the beam is on, from its begin to its end.
struct HatchPiece {
  Vec from, to;
};
using HatchRow = std::vector<HatchPiece>;  ///< never empty

struct HatchOptions {
  double distance_mm = 0;
  double angle_deg = 0;  ///< of the lines, counter-clockwise from X
};

/// Rows in the order of their distance from the first one, all in the same direction. The outline
/// of an area is around places by its rule; of those around a place the one painted last decides
/// whether it is filled. A place without an area around it is filled if an odd number of the other
/// contours is around it. Open contours are skipped. `missed` gets the numbers of
/// the closed contours that no row crosses, if it is not null. Throws Error (bad_input) for a
/// distance that is not positive and for more than model::max_pieces rows.
std::vector<HatchRow> hatch(const std::vector<Contour>& contours, const HatchOptions& options,
                            std::vector<std::size_t>* missed = nullptr);

}  // namespace lamplock::cutting
