// Compensation of the beam: contours moved aside by half its width.
//
// In:  contours of lines and arcs. Out: the contours of all points at the distance, lines and arcs
//      again, and where the beam does not fit.
// Who: the preparation of a cut.
//
// A laser on the drawn contour removes half of its width on both sides: the part gets smaller by
// the kerf and the hole larger. The result is exact: a line stays a line, an arc gets the radius +-
// d, a convex corner an arc of radius d (or a mitre), a concave one the intersection. Every point
// of the result lies on one of these raw edges. So all raw edges are cut at their intersections,
// and of the pieces those remain whose distance from all contours is d; the rest is nearer.
//
// Closed contours that cross themselves or others are replaced by the boundary of their area before
// (simple_contours.hpp), and reported.
//
//   contours -> raw edges -> pieces between intersections -> pieces at distance d -> loops
#pragma once

#include <cstddef>
#include <vector>

#include "host/cutting/contour.hpp"

namespace lamplock::cutting {

enum class Join {
  arc,   ///< convex corners become arcs: all points have exactly the distance
  mitre  ///< sharp: the tangents are prolonged to their intersection, up to max_mitre
};

struct OffsetOptions {
  /// mm, positive to the right of the direction: outside of contours that run counter-clockwise,
  /// inside of others. Half the beam width.
  double distance_mm = 0;
  Join join = Join::arc;
  /// A corner whose mitre would be further from the corner than this times the distance gets an
  /// arc; the default is that of SVG's stroke-miterlimit, a corner of 29 degrees.
  double max_mitre = 4;
};

struct OffsetContours {
  std::vector<Contour> contours;  ///< in the directions of the originals
  std::vector<std::size_t> from;  ///< number of the original of each
  std::vector<Fault>
      faults;  ///< narrow, vanished, and those of contour_faults(); numbers of originals
};

/// Contours of one call act together: where two of them are nearer than twice the distance, their
/// offsets are joined. So parts that are cut by themselves are offset by themselves. Open contours
/// are offset on one side, without caps. Throws Error (bad_input) for a distance that is not finite
/// or a max_mitre below 1.
OffsetContours offset(const std::vector<Contour>& contours, const OffsetOptions& options);

}  // namespace lamplock::cutting
