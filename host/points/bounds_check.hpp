// The last check before a cloud becomes a job. In: a cloud and its allowed box. Out: nothing, or
// one error. Called before ordering and before any motion.
#pragma once

#include <span>
#include <string>

#include "host/geometry/bounds.hpp"

namespace lamplock::points {

/// Throws Error (bad_input) unless every point is finite and inside `room`, or outside of it by no
/// more than the rounding of scaled coordinates, 1e-6 mm; the error names index
/// (from 0) and coordinates of the first bad point and the number of bad ones. `where` names the
/// input, usually the file, `place` the room.
void check_bounds(std::span<const geometry::Point> cloud, const geometry::Bounds& room,
                  const std::string& where, const std::string& place = "the work space");

}  // namespace lamplock::points
