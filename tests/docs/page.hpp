// Files of the repository, for tests that hold a page against the code it speaks of.
#pragma once

#include <fstream>
#include <sstream>
#include <string>

namespace lamplock::test {

/// Text of a file, named from the root of the repository; empty if it is not there.
inline std::string read_repository_file(const std::string& path) {
  std::ifstream file(LAMPLOCK_ROOT "/" + path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace lamplock::test
