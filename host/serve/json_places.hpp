// Places and boxes in the messages of the server: [x, y, z] and [low, high], mm.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "host/geometry/bounds.hpp"

namespace lamplock::serve {

nlohmann::json place_json(const geometry::Point& place);
nlohmann::json box_json(const geometry::Bounds& box);

}  // namespace lamplock::serve
