// Transformations of an object, in words, one after the other.
//
//   move X Y Z            by so many mm
//   rotate x|y|z DEG      about the middle of the block, counter-clockwise seen from the axis' tip
//   rotate X Y Z DEG      the same about any axis
//   scale F, scale X Y Z  from the middle of the block
//   mirror x|y|z          left and right of the plane through the middle of the block
//   centre                the middle of the object's box goes to the middle of the block
//   fit                   as large as the block less its margin and the machine permit, in the
//                         middle of that room
//
// In:  the words, as a description or the command line has them; the box of the object under a map;
//      the block. Out: one map for all of them. Who: the command line, before an object becomes
//      points: spacings hold in the block, however the object is scaled.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "host/glass/volume.hpp"
#include "host/model/affine.hpp"
#include "host/points/bounds.hpp"

namespace lamplock::glass {

/// Throws Error(bad_input), at `where`, if these are not the words of one transformation.
void check_transformation(const std::string& words, const std::string& where);

/// The box of an object under a map.
using BoxUnder = std::function<points::Bounds(const model::Affine&)>;

/// `first`, then the transformations in their order, in this volume. Throws Error(bad_input), at
/// `where`, for words that are none, and for `fit` of an object without extent.
model::Affine placement(const model::Affine& first, std::span<const std::string> transformations,
                        const Volume& volume, const BoxUnder& box_under, const std::string& where);

/// The largest factor by which a box can be scaled and still has no side longer than those of
/// `room`; infinite for a box without extent.
double fitting_scale(const points::Bounds& box, const points::Bounds& room);

}  // namespace lamplock::glass
