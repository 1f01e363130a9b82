// The extent of a line: the box of all places that it reaches, before anything moves.
//
// In:  the plan of a line with a curve, a cycle or an intermediate place, and its rotation.
// Out: the lowest and highest coordinate of each axis, in machine coordinates, in closed form: the
//      quarters of an arc, the extremes of a spline, the levels of a cycle.
// Who: the interpreter, for the check of soft limits; main loop, once for a line that is no single
//      straight move.
//
// The box is exact, but for three cases in which it is larger than what is reached: a NURBS counts
// with all its control points, a spiral with its larger radius, and an arc that G68 turns out of
// its plane with the corners of the box before the rotation.
#pragma once

#include "firmware/program/curves/arc.hpp"
#include "firmware/program/curves/nurbs.hpp"
#include "firmware/program/curves/spline.hpp"
#include "firmware/program/cycles.hpp"
#include "firmware/program/rotation.hpp"

namespace lamplock::program {

/// Machine coordinates, 10^-7 mm.
class Extent {
 public:
  explicit Extent(const Place& place) : low_(place), high_(place) {}

  [[gnu::cold]] void add(const Place& place);
  const Place& low() const { return low_; }
  const Place& high() const { return high_; }

 private:
  Place low_, high_;
};

/// Extents of programmed curves and cycles, with these rotations in force.
[[gnu::cold]] Extent extent_of(const ArcRequest& arc, const Rotations& rotations);
[[gnu::cold]] Extent extent_of(const SplineRequest& spline, const Rotations& rotations);
[[gnu::cold]] Extent extent_of(const NurbsRequest& nurbs, const Rotations& rotations);
[[gnu::cold]] Extent extent_of(const CycleRequest& cycle, const Rotations& rotations);

}  // namespace lamplock::program
