// The version of the program. Called by the command line, reports and the manual.
#pragma once

namespace lamplock {

/// "0.1.0", from project() of CMakeLists.txt.
const char* version();

}  // namespace lamplock
