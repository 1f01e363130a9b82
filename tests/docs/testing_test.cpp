// docs/testing.md: the functions and tests of its table of rules that were broken on purpose exist.
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tests/docs/page.hpp"

namespace lamplock::test::testing_page {
namespace {

using Rows = std::vector<std::vector<std::string>>;

/// Cells of the rows of a table, without its two lines of heading.
Rows rows_of_table(const std::string& page, const std::string& heading) {
  Rows rows;
  std::istringstream lines(page.substr(std::min(page.find(heading), page.size())));
  std::string line;
  for (int i = 0; std::getline(lines, line) && line.starts_with("|"); ++i) {
    if (i < 2) continue;
    std::istringstream cells(line.substr(1));
    std::string cell;
    rows.emplace_back();
    while (std::getline(cells, cell, '|')) rows.back().push_back(cell);
  }
  return rows;
}

/// Texts between backticks.
std::vector<std::string> quoted(const std::string& cell) {
  std::vector<std::string> texts;
  const std::regex quote("`([^`]+)`");
  for (std::sregex_iterator at(cell.begin(), cell.end(), quote), end; at != end; ++at)
    texts.push_back((*at)[1]);
  return texts;
}

bool has_word(const std::string& text, const std::string& word) {
  return std::regex_search(text, std::regex("\\b" + word + "\\b"));
}

TEST(TestingPage, NamesFunctionsThatExist) {
  const Rows rows =
      rows_of_table(read_repository_file("docs/testing.md"), "| rule | file, function | change |");
  ASSERT_GT(rows.size(), 50u);
  std::string file, text;
  for (const auto& row : rows) {
    std::vector<std::string> names = quoted(row.at(1));
    if (!names.empty() && names[0].find('.') != std::string::npos) {
      file = names[0];
      text = read_repository_file(file);
      names.erase(names.begin());
    }
    ASSERT_FALSE(text.empty()) << "no file " << file;
    for (const std::string& name : names)
      EXPECT_TRUE(has_word(text, name.substr(name.rfind(':') + 1))) << file << " has no " << name;
  }
}

TEST(TestingPage, NamesTestsThatExist) {
  std::string sources = sources_of_tests();
  std::erase_if(sources, [](char c) { return c == ' ' || c == '\n'; });
  const std::regex test(R"((?:\w+/)?(\w+)\.(\w+))");
  std::smatch name;
  int named = 0;
  for (const auto& row : rows_of_table(read_repository_file("docs/testing.md"), "| rule | file"))
    for (const std::string& text : quoted(row.at(3))) {
      // Tests of the pages are programs for Node.js.
      if (!std::regex_match(text, name, test) || name[1] == "page") continue;
      ++named;
      const std::string defined = "(" + name[1].str() + "," + name[2].str();
      EXPECT_NE(sources.find(defined), std::string::npos) << text;
    }
  EXPECT_GT(named, 50);
}

}  // namespace
}  // namespace lamplock::test::testing_page
