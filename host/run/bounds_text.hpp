// Boxes in text. Who: every use case that makes or shows points.
#pragma once

#include <string>

#include "host/geometry/bounds.hpp"

namespace lamplock::run {

/// "x -10..10, y -5..5, z 0..20 mm".
std::string bounds_text(const geometry::Bounds& bounds);

}  // namespace lamplock::run
