// Source files that documents and comments name exist: a file that moves leaves no wrong names.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/docs/page.hpp"

namespace lamplock::test::named_files {
namespace {

namespace fs = std::filesystem;

constexpr std::array rooms{"firmware", "host", "sim", "shared", "tests", "toolchain", "docs"};

std::vector<fs::path> files_of_the_repository() {
  std::vector<fs::path> files;
  for (const char* room : rooms)
    for (const auto& entry : fs::recursive_directory_iterator(in_repository(room)))
      if (entry.is_regular_file()) files.push_back(entry.path());
  for (const char* page : {"README.md", "CONTRIBUTING.md", "RELEASE.md"})
    files.emplace_back(in_repository(page));
  return files;
}

bool is_source(const fs::path& file) {
  return file.extension() == ".hpp" || file.extension() == ".cpp";
}

/// Names by which text can name the sources: the path from the top, and what is left of it without
/// its first folders.
std::set<std::string> possible_names(const std::vector<fs::path>& files) {
  std::set<std::string> names;
  const fs::path top = in_repository("");
  for (const fs::path& file : files) {
    if (!is_source(file)) continue;
    std::string name = file.lexically_relative(top).generic_string();
    for (;;) {
      names.insert(name);
      const std::size_t slash = name.find('/');
      if (slash == std::string::npos) break;
      name.erase(0, slash + 1);
    }
  }
  return names;
}

/// Capital letters are a place for a name: NAME.hpp.
bool is_pattern(const std::string& name) {
  const std::string base = name.substr(name.rfind('/') + 1);
  return std::any_of(base.begin(), base.end(),
                     [](unsigned char c) { return std::isupper(c) != 0; });
}

TEST(NamedFiles, Exist) {
  const std::vector<fs::path> files = files_of_the_repository();
  const std::set<std::string> names = possible_names(files);
  ASSERT_GT(names.size(), 1000u);
  // Not the end of a pattern: `*_test.cpp`, `<name>.hpp`.
  const std::regex source(R"((^|[^\w/.<>*$}-])((?:[\w.-]+/)*[\w-]+\.[hc]pp)\b)");
  std::size_t named = 0;
  for (const fs::path& file : files) {
    const bool is_page = file.extension() == ".md";
    if (!is_page && !is_source(file)) continue;
    std::ifstream lines(file);
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
      if (line.find("pp") == std::string::npos) continue;
      const std::size_t comment = is_page ? 0 : line.find("//");
      if (comment == std::string::npos) continue;
      const std::string text = line.substr(comment);
      for (std::sregex_iterator at(text.begin(), text.end(), source), end; at != end; ++at) {
        const std::string name = (*at)[2];
        if (is_pattern(name)) continue;
        ++named;
        EXPECT_TRUE(names.contains(name)) << file << ":" << number << " names " << name;
      }
    }
  }
  EXPECT_GT(named, 500u);
}

}  // namespace
}  // namespace lamplock::test::named_files
