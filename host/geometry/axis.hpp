// The three axes by name, for options of the user.
#pragma once

namespace lamplock::geometry {

enum class Axis { x, y, z };

}  // namespace lamplock::geometry
