// JSON from clients, whose depth is limited: copies and texts of JSON use a frame of the stack for
// each level.
//
// In:  bytes of a client, which may not have logged in. Out: the value, discarded if it is not
// valid. Who: the server, the logins, the interface of OctoPrint.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace lamplock::serve {

/// Lists and objects inside each other that a client may send: far more than any method has.
inline constexpr int max_json_depth = 32;

/// The value; is_discarded() if the text is not valid JSON or is deeper than max_json_depth.
nlohmann::json client_json(const std::string& text);

}  // namespace lamplock::serve
