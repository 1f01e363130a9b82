// `lamplock cut`: options of a run beside a description, operations that are off, contours of a
// lathe, programs of other post-processors.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/cli/program.hpp"
#include "tests/drawings.hpp"

namespace lamplock::cli::test::cut_options {
namespace {

using testing::HasSubstr;
using testing::Not;
using Arguments = std::vector<std::string>;
using nlohmann::json;
using namespace lamplock::test;

class CutOptions : public testing::Test {
 protected:
  /// Cuts the drawing with 80 % and 600 mm/min.
  Finished cut(const Arguments& more) const {
    Arguments all{"cut", part_, "--power", "80", "--feed", "600", "-o", program_};
    all.insert(all.end(), more.begin(), more.end());
    return run(all);
  }
  /// The one line of a refusal; nothing is written.
  std::string refused(const Finished& wrong) const {
    EXPECT_EQ(wrong.status, 2) << wrong.out << wrong.err;
    std::string error;
    for (const std::string& line : lines(wrong.err))
      if (line.starts_with("error: ")) error += line;
    EXPECT_THAT(error, testing::MatchesRegex("error: [^\n]+: [^\n]+; [^\n]+"));
    EXPECT_FALSE(std::filesystem::exists(program_));
    return error;
  }
  void draw(const std::string& entities) const {
    folder_.write("part.dxf", dxf_drawing(entities, 4));
  }

  Folder folder_;
  const std::string part_ = folder_.write(
      "part.dxf", dxf_drawing(dxf_rectangle(5, 5, 25, 20) + dxf_circle(15, 12, 3), 4));
  const std::string program_ = folder_ / "part.ngc";
};

TEST_F(CutOptions, a_description_does_not_lose_a_dry_run) {
  const std::string saved = folder_ / "job.toml";
  for (const Arguments& option :
       {Arguments{"--dry"}, Arguments{"--frame"}, Arguments{"--from", "2"}}) {
    Arguments more = option;
    more.insert(more.end(), {"--save", saved});
    EXPECT_THAT(refused(cut(more)),
                HasSubstr(option.front() + ": is not saved in a description; leave it out"));
    EXPECT_FALSE(std::filesystem::exists(saved));
  }
  ASSERT_EQ(cut({"--save", saved}).status, 0);
  ASSERT_EQ(run({"cut", saved, "--dry", "-o", program_}).status, 0);
  EXPECT_THAT(read(program_), Not(HasSubstr("S800")));
}

}  // namespace
}  // namespace lamplock::cli::test::cut_options
