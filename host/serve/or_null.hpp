// Values that may be missing, in JSON.
//
// In:  an optional value. Out: the value, or null. Who: the results of methods.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

namespace lamplock::serve {

template <class T>
nlohmann::json or_null(const std::optional<T>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}

}  // namespace lamplock::serve
