#include "host/serve/json_places.hpp"

#include <nlohmann/json.hpp>

namespace lamplock::serve {

nlohmann::json place_json(const geometry::Point& place) { return {place.x, place.y, place.z}; }

nlohmann::json box_json(const geometry::Bounds& box) {
  return {place_json(box.low), place_json(box.high)};
}

}  // namespace lamplock::serve
