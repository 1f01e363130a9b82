// The pictures of docs/planning.md are shown, small, and made by the commands under them.
#include <gmock/gmock.h>

#include <algorithm>
#include <sstream>

#include "tests/cli/program.hpp"
#include "tests/paths.hpp"

namespace lamplock::cli::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// A picture of the page and the command under it.
struct Picture {
  std::string name;
  std::vector<std::string> arguments;
};

/// Lines "lamplock engrave ... --plot docs/images/NAME.svg ...".
std::vector<Picture> pictures_of_the_page() {
  std::istringstream page(read(lamplock::test::in_repository("docs/planning.md")));
  std::vector<Picture> pictures;
  for (std::string line; std::getline(page, line);) {
    std::istringstream words(line);
    std::string word;
    if (!(words >> word) || word != "lamplock") continue;
    Picture picture;
    while (words >> word) picture.arguments.push_back(word);
    const auto plot = std::find(picture.arguments.begin(), picture.arguments.end(), "--plot");
    if (picture.arguments.end() - plot < 2) continue;
    picture.name = plot[1];
    pictures.push_back(picture);
  }
  return pictures;
}

std::string title_of(const std::string& svg) {
  const auto from = svg.find("bold"), to = svg.find("</text>");
  return from == std::string::npos || to < from ? "none" : svg.substr(from, to - from);
}

TEST(Pictures, OfThePageAreMadeByTheCommandsUnderThem) {
  const std::string root = lamplock::test::in_repository("");
  const std::string page = read(root + "docs/planning.md");
  const std::vector<Picture> pictures = pictures_of_the_page();
  ASSERT_GE(pictures.size(), 8u);
  const Folder folder;
  for (const Picture& picture : pictures) {
    SCOPED_TRACE(picture.name);
    EXPECT_THAT(page, HasSubstr("](" + picture.name.substr(5) + ")")) << "not shown";
    const std::string kept = read(root + picture.name);
    EXPECT_THAT(kept, StartsWith("<svg "));
    EXPECT_LT(kept.size(), 60'000u);
    std::vector<std::string> arguments;
    for (const std::string& word : picture.arguments)
      arguments.push_back(word == picture.name          ? folder / "new.svg"
                          : word.rfind("docs/", 0) == 0 ? root + word
                                                        : word);
    const Finished done = run(arguments);
    ASSERT_EQ(done.status, 0) << done.err;
    // An improved planner draws other curves, but of the same job.
    EXPECT_EQ(title_of(read(folder / "new.svg")), title_of(kept));
  }
}

}  // namespace
}  // namespace lamplock::cli::test
