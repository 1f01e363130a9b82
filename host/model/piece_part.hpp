// Parts of curves between two of their parameters.
//
// In:  pieces and paths. Out: the part as a piece of the same kind, exact; the part of a path as a
//      path.
// Who: dashes(), clipped().
#pragma once

#include "host/model/arc_length.hpp"
#include "host/model/curves.hpp"

namespace lamplock::model {

/// The part from one parameter to a greater one (in the direction of the piece). Splines must be
/// Bezier curves without weights, as those of SVG are.
Piece part_of(const Piece& piece, double from, double to);

/// The part between two places, the first before the second; open. Empty if it has no extent.
Path part_of(const Path& path, const ArcLength::Place& from, const ArcLength::Place& to);

}  // namespace lamplock::model
