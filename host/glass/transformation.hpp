// Transformations of an object, in words, applied in order.
//
//   move X Y Z            by this vector in mm
//   rotate x|y|z DEG      about the middle of the block, counter-clockwise seen from the axis' tip
//   rotate X Y Z DEG      the same about any axis
//   scale F, scale X Y Z  from the middle of the block
//   mirror x|y|z          at the plane through the middle of the block
//   centre                moves the middle of the object's box to the middle of the block
//   fit                   scales to the largest size inside the block's margin and the machine's
//                         travel, and centres the object there
//
// In:  the words of a description or the command line; the box of the object under a map; the
//      block. Out: one map for all of them. Who: the command line, before points are made of an
//      object, so that scaling does not change the spacing.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "host/geometry/affine.hpp"
#include "host/geometry/bounds.hpp"
#include "host/glass/volume.hpp"

namespace lamplock::glass {

/// Throws Error(bad_input), at `where`, if these are not the words of a transformation.
void check_transformation(const std::string& words, const std::string& where);

/// The box of an object under a map.
using BoxUnder = std::function<geometry::Bounds(const geometry::Affine&)>;

/// What an object has on each side of its box under a map, mm along x, y and z, in any scale: the
/// layers of a picture.
using MarginUnder = std::function<geometry::Point(const geometry::Affine&)>;

/// `first`, then the transformations in their order, in this volume. Throws Error(bad_input), at
/// `where`, for wrong words, for `fit` of an object without extent, and of one whose margin fills
/// the room.
geometry::Affine placement(const geometry::Affine& first,
                           std::span<const std::string> transformations, const Volume& volume,
                           const BoxUnder& box_under, const std::string& where,
                           const MarginUnder& margin_under = nullptr);

/// The largest scale factor of a box whose sides then fit into `room`; infinite for a box without
/// extent.
double fitting_scale(const geometry::Bounds& box, const geometry::Bounds& room);

}  // namespace lamplock::glass
