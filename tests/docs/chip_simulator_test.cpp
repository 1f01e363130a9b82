// Tests and images named in docs/chip-simulator.md must exist.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>
#include <string>

#include "tests/docs/page.hpp"
#include "tests/paths.hpp"

namespace lamplock {
namespace {

using testing::Contains;

/// First groups of all matches.
std::set<std::string> found(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  std::set<std::string> result;
  for (std::sregex_iterator it(text.begin(), text.end(), regex), end; it != end; ++it)
    result.insert((*it)[1].str() + ((*it).size() > 2 ? '.' + (*it)[2].str() : ""));
  return result;
}

std::set<std::string> tests_in(const std::string& folder) {
  std::set<std::string> result;
  for (const auto& file : std::filesystem::directory_iterator(test::in_repository(folder))) {
    if (file.path().extension() != ".cpp") continue;
    const std::string name = folder + '/' + file.path().filename().string();
    result.merge(found(test::read_repository_file(name), R"(TEST(?:_F)?\((\w+),\s+(\w+)\))"));
  }
  return result;
}

TEST(ChipSimulatorPage, NamesTestsThatExist) {
  const std::string page = test::read_repository_file("docs/chip-simulator.md");
  const std::set<std::string> tests = tests_in("tests/chip");
  const std::set<std::string> named = found(page, R"(`([A-Z]\w+)\.([A-Z]\w+)`)");
  EXPECT_GE(named.size(), 50u);
  for (const std::string& name : named) EXPECT_THAT(tests, Contains(name));
  for (const std::string& file : found(page, R"(`(\w+_test)`)"))
    EXPECT_TRUE(std::filesystem::exists(test::in_repository("tests/chip/" + file + ".cpp")))
        << file;
}

TEST(ChipSimulatorPage, NamesImagesThatExist) {
  const std::string page = test::read_repository_file("docs/chip-simulator.md");
  const std::set<std::string> images = found(page, R"(`chip_images\.(\w*[a-z])`)");
  EXPECT_GE(images.size(), 5u);
  for (const std::string& image : images)
    EXPECT_TRUE(
        std::filesystem::exists(test::in_repository("tests/chip_images/" + image + ".script")))
        << image;
}

}  // namespace
}  // namespace lamplock
