// The block of glass: its size and position, and the margin without points at its faces.
//
// A defect near a face cracks it, so a margin of 3 to 5 mm is usual ("Mechatronic positioning of a
// pulsed laser beam in devices forming 3-D objects in glass").
//
// In:  size, middle and margin in mm. Out: the box of the glass and the box for points.
// Who: descriptions of jobs; the placement of objects and the check of their points.
#pragma once

#include "host/geometry/bounds.hpp"
#include "host/geometry/point.hpp"

namespace lamplock::glass {

/// Default margin, mm.
inline constexpr double default_margin_mm = 3;

/// A block with faces along the axes; the beam enters at the top.
struct Block {
  geometry::Point size_mm;
  geometry::Point middle_mm{};
  double margin_mm = default_margin_mm;

  /// The box of the glass.
  geometry::Bounds outside() const;
  /// The box for points.
  geometry::Bounds inside() const;
  /// z of the face through which the beam enters.
  double entry_mm() const { return middle_mm.z + size_mm.z / 2; }
};

/// Throws Error(bad_input) unless all sides are greater than 0 and finite, the margin is 0 or more
/// and leaves room for points.
void require_block(const Block& block);

}  // namespace lamplock::glass
