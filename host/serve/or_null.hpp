// Values that may be missing, in JSON.
//
// In:  an optional value. Out: the value, or null. Who: the results of methods.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>

namespace lamplock::serve {

nlohmann::json or_null(const std::optional<double>& value);
nlohmann::json or_null(const std::optional<std::int64_t>& value);

}  // namespace lamplock::serve
