// LAMPLOCK_VERSION is defined for this file alone, so that a new version compiles no other.
#include "host/version.hpp"

namespace lamplock {

const char* version() { return LAMPLOCK_VERSION; }

}  // namespace lamplock
