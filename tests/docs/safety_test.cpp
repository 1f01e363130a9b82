// docs/safety.md names an existing test for each of its figures.
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <string>

#include "tests/docs/page.hpp"

namespace lamplock::test {
namespace {

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
