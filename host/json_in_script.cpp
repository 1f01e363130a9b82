#include "host/json_in_script.hpp"

#include <nlohmann/json.hpp>

namespace lamplock {

std::string json_in_script(const nlohmann::ordered_json& json) {
  const std::string text =
      json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) {
    if (c == '<')
      safe += "\\u003c";
    else
      safe.push_back(c);
  }
  return safe;
}

}  // namespace lamplock
