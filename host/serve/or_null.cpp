#include "host/serve/or_null.hpp"

#include <nlohmann/json.hpp>

namespace lamplock::serve {

nlohmann::json or_null(const std::optional<double>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}

nlohmann::json or_null(const std::optional<std::int64_t>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}

}  // namespace lamplock::serve
