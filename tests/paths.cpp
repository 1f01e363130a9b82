#include "tests/paths.hpp"

namespace lamplock::test {

std::string in_repository(std::string_view path) {
  return std::string(LAMPLOCK_REPOSITORY "/").append(path);
}
std::string in_build(std::string_view path) { return std::string(LAMPLOCK_BUILD "/").append(path); }

}  // namespace lamplock::test
