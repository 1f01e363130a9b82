#include "host/serve/client_json.hpp"

#include <nlohmann/json.hpp>

namespace lamplock::serve {

nlohmann::json client_json(const std::string& text) {
  using Json = nlohmann::json;
  bool is_too_deep = false;
  // Values that are too deep are not stored.
  const auto keep = [&is_too_deep](int depth, Json::parse_event_t, const Json&) {
    if (depth > max_json_depth) is_too_deep = true;
    return depth <= max_json_depth;
  };
  Json value = Json::parse(text, keep, false);
  if (is_too_deep) return Json(Json::value_t::discarded);
  return value;
}

}  // namespace lamplock::serve
