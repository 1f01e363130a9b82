// LAMPLOCK_VERSION is defined for this file only, so that a new version recompiles no other file.
#include "host/version.hpp"

namespace lamplock {

const char* version() { return LAMPLOCK_VERSION; }

}  // namespace lamplock
