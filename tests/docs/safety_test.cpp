// docs/safety.md names an existing test for each of its figures.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>

#include "tests/docs/page.hpp"
#include "tests/paths.hpp"

namespace lamplock::test {
namespace {

/// All sources of tests, concatenated.
std::string sources_of_tests() {
  namespace fs = std::filesystem;
  std::ostringstream text;
  for (const fs::directory_entry& entry :
       fs::recursive_directory_iterator(test::in_repository("tests")))
    if (entry.path().extension() == ".cpp") text << std::ifstream(entry.path()).rdbuf();
  return text.str();
}

TEST(SafetyPage, NamesATestForEachFigure) {
  const std::string page = read_repository_file("docs/safety.md");
  const std::size_t begin = page.find("| figure | at most | test |");
  ASSERT_NE(begin, std::string::npos);
  const std::string table = page.substr(begin, page.find("\n\n", begin) - begin);
  const std::string sources = sources_of_tests();
  const std::regex row(R"(\| `(\w+)\.(\w+)` \|)");
  int named = 0;
  for (std::sregex_iterator at(table.begin(), table.end(), row), end; at != end; ++at, ++named) {
    const std::string test = "(" + (*at)[1].str() + ", " + (*at)[2].str() + ")";
    EXPECT_NE(sources.find(test), std::string::npos) << test;
  }
  EXPECT_EQ(named, std::count(table.begin(), table.end(), '\n') - 1) << "a row without a test";
}

}  // namespace
}  // namespace lamplock::test
