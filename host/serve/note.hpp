// Lines for the log of the server. Who: the server, logins.
#pragma once

#include <functional>
#include <string>

namespace lamplock::serve {

/// Takes a line for the log.
using Note = std::function<void(const std::string&)>;

}  // namespace lamplock::serve
