// The values are defined for this file only, so that a new version recompiles no other file.
#include "host/version.hpp"

namespace lamplock {

const char* version() { return LAMPLOCK_VERSION; }

std::string_view compiler() { return LAMPLOCK_COMPILER; }

std::string_view build_type() { return LAMPLOCK_BUILD_TYPE; }

std::vector<Library> libraries() {
  std::vector<Library> libraries;
  std::string_view rest = LAMPLOCK_LIBRARIES;  // "fmt 9.1.0,libpng 1.6.39"
  while (!rest.empty()) {
    const std::string_view one = rest.substr(0, rest.find(','));
    rest.remove_prefix(one.size() < rest.size() ? one.size() + 1 : one.size());
    const auto space = one.find(' ');
    libraries.push_back({one.substr(0, space), one.substr(space + 1)});
  }
  return libraries;
}

}  // namespace lamplock
