// The block of glass: how large it is, where it lies, how far from its faces points have to stay.
//
// A defect near a face cracks it, so 3 to 5 mm inside the glass stay free ("Mechatronic positioning
// of a pulsed laser beam in devices forming 3-D objects in glass").
//
// In:  size, middle and margin in mm. Out: the box of the glass and the box that points may be in.
// Who: descriptions of jobs; the placement of objects and the check of their points.
#pragma once

#include "host/points/bounds.hpp"
#include "host/points/point.hpp"

namespace lamplock::glass {

/// What stays free inside the faces unless the user says, mm.
inline constexpr double default_margin_mm = 3;

/// A block with faces along the axes; the beam enters at the top.
struct Block {
  points::Point size_mm;
  points::Point middle_mm{};
  double margin_mm = default_margin_mm;

  /// The glass.
  points::Bounds outside() const;
  /// Where points may be.
  points::Bounds inside() const;
  /// z of the face the beam comes through.
  double entry_mm() const { return middle_mm.z + size_mm.z / 2; }
};

/// Throws Error(bad_input) unless all sides are greater than 0 and finite, the margin is 0 or more
/// and something is left inside it.
void require_block(const Block& block);

}  // namespace lamplock::glass
