// The last gate before a cloud becomes a job. Comes in: a cloud and where it may be. Goes out:
// nothing, or one error. Called before ordering and before anything moves.
#pragma once

#include <span>
#include <string>

#include "host/points/bounds.hpp"

namespace lamplock::points {

/// Throws Error (bad_input) unless every point is finite and inside `room`; the error names index
/// (from 0) and coordinates of the first bad point and how many there are. `where` names the input,
/// as a rule the file, `place` what the room is.
void check_bounds(std::span<const Point> cloud, const Bounds& room, const std::string& where,
                  const std::string& place = "the work space");

}  // namespace lamplock::points
