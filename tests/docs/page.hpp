// Files of the repository, for tests that compare a page with the code.
#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "tests/paths.hpp"

namespace lamplock::test {

/// Text of a file, named from the root of the repository; empty if it does not exist.
inline std::string read_repository_file(const std::string& path) {
  std::ifstream file(test::in_repository(path));
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// All sources of tests, concatenated.
inline std::string sources_of_tests() {
  std::ostringstream text;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(test::in_repository("tests")))
    if (entry.path().extension() == ".cpp") text << std::ifstream(entry.path()).rdbuf();
  return text.str();
}

}  // namespace lamplock::test
