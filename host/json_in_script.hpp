// JSON inside a script element of a page.
//
// In:  JSON. Out: its text, in which no text ends the element. Who: the pages of reports and plans.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace lamplock {

std::string json_in_script(const nlohmann::ordered_json& json);

}  // namespace lamplock
