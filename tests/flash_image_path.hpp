// The flash image under test.
#pragma once

#include <cstdlib>
#include <string>

#include "tests/paths.hpp"

namespace lamplock::test {

/// The image of the build at 125 MHz, or that of the environment variable LAMPLOCK_TEST_IMAGE.
inline std::string flash_image_path() {
  const char* other = std::getenv("LAMPLOCK_TEST_IMAGE");
  return other != nullptr ? other : in_build("lamplock-rp2040.elf");
}

}  // namespace lamplock::test
