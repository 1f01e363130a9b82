// The last gate before a cloud becomes a job. Comes in: a cloud and the work space. Goes out:
// nothing, or one error. Called before ordering and before anything moves.
#pragma once

#include <span>
#include <string>

#include "host/points/bounds.hpp"

namespace lamplock::points {

/// Throws Error (bad_input) unless every point is finite and inside `work_space`; the error names
/// index (from 0) and coordinates of the first bad point and how many there are. `where` names
/// the input, as a rule the file.
void check_bounds(std::span<const Point> cloud, const Bounds& work_space, const std::string& where);

}  // namespace lamplock::points
