// Boxes, for people and for programs. Who: every command that makes or shows points.
#pragma once

#include <string>

#include "host/cli/json.hpp"
#include "host/points/bounds.hpp"

namespace lamplock::cli {

/// "x -10..10, y -5..5, z 0..20 mm".
std::string bounds_text(const points::Bounds& bounds);
Json bounds_json(const points::Bounds& bounds);

}  // namespace lamplock::cli
