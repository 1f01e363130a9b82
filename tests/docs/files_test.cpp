// docs/files.md lists exactly the extensions of the table of readers.
#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <string>

#include "host/model/input.hpp"
#include "tests/docs/page.hpp"

namespace lamplock::model {
namespace {

TEST(FilesPage, ListsTheExtensions) {
  const std::string page = test::read_repository_file("docs/files.md");
  const std::size_t from = page.find("| extension |");
  ASSERT_NE(from, std::string::npos);
  const std::string table = page.substr(from, page.find("\n\n", from) - from);
  std::set<std::string> listed, known;
  const auto add_all = [](const std::string& text, const std::regex& name, auto& names) {
    for (std::sregex_iterator m(text.begin(), text.end(), name), end; m != end; ++m)
      names.insert((*m)[1]);
  };
  // Of each row the first cell.
  const std::regex row("\n(\\| `[^|]*)\\|"), quoted("`\\.(\\w+)`"), word("(\\w+)");
  for (std::sregex_iterator r(table.begin(), table.end(), row), end; r != end; ++r)
    add_all((*r)[1], quoted, listed);
  for (const InputKind kind :
       {InputKind::mesh, InputKind::bitmap, InputKind::points, InputKind::curves})
    add_all(extensions(kind), word, known);
  EXPECT_EQ(listed, known);
}

}  // namespace
}  // namespace lamplock::model
