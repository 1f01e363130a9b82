// JSON as commands print it. Documents are made in .cpp files, which include <nlohmann/json.hpp>.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace lamplock::cli {

/// Keys in the order in which they were put in.
using Json = nlohmann::ordered_json;

}  // namespace lamplock::cli
