#include "host/error.hpp"

#include "host/printable.hpp"

namespace lamplock {

Error::Error(Exit exit, const std::string& where, const std::string& what,
             const std::string& remedy)
    : std::runtime_error(printable(std::string(prefix) + (where.empty() ? "''" : where) + ": " +
                                   what + "; " + remedy)),
      exit_(exit) {}

}  // namespace lamplock
