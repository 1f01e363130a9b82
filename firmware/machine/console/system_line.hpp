// Lines that begin with "$", as users type them: spaces, lower case and comments do not count. The
// texts of `$I=` and `$N0=` stay as they are.
//
// In:  a line of the host. Out: the line as the console compares it. Who: the console, main loop.
#pragma once

#include <span>
#include <string_view>

namespace lamplock::machine {

/// The line is a jog: "$J=".
bool is_jog(std::string_view line);
/// Makes it plain in place.
std::string_view plain_system_line(std::span<char> line);

}  // namespace lamplock::machine
