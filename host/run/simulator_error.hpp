// Errors of the simulator, which knows nothing of this program, as the user reads them.
#pragma once

#include <string>

namespace lamplock::run {

/// Throws Error(bad_input) for a text "WHERE: WHAT; REMEDY".
[[noreturn]] void refuse(const std::string& text);

}  // namespace lamplock::run
