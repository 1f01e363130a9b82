// The version of the program and what it is built with. Called by the command line, reports and the
// manual.
#pragma once

#include <string_view>
#include <vector>

namespace lamplock {

/// "0.1.0", from project() of CMakeLists.txt.
const char* version();

/// "GNU 12.2.0".
std::string_view compiler();

/// "Release".
std::string_view build_type();

struct Library {
  std::string_view name, version;
};
/// Libraries of others that the program is built with, and their versions then.
std::vector<Library> libraries();

}  // namespace lamplock
