// The three axes by name. Called by whoever lets the user choose one.
#pragma once

namespace lamplock::points {

enum class Axis { x, y, z };

}  // namespace lamplock::points
