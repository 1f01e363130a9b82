// The flash image under test.
#pragma once

#include <cstdlib>
#include <string>

namespace lamplock::test {

/// The image of the build at 125 MHz, or that of the environment variable LAMPLOCK_TEST_IMAGE.
inline std::string flash_image_path() {
  const char* other = std::getenv("LAMPLOCK_TEST_IMAGE");
  return other != nullptr ? other : LAMPLOCK_IMAGE;
}

}  // namespace lamplock::test
