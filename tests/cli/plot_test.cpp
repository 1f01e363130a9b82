// --plot and --hold-at.
#include <gmock/gmock.h>

#include "tests/cli/inputs.hpp"
#include "tests/cli/program.hpp"

namespace lamplock::cli::test {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

TEST(Plot, IsWrittenAndTheSameEachTime) {
  const Folder folder;
  const std::string points = folder.write("a & b.xyz", xyz(walk(30, 1)));
  for (const char* name : {"one.svg", "two.svg"}) {
    const Finished done = run({"engrave", points, "--lamp", "100", "--plot", folder / name});
    ASSERT_EQ(done.status, 0) << done.err;
  }
  const std::string picture = read(folder / "one.svg");
  EXPECT_THAT(picture, StartsWith("<svg "));
  EXPECT_THAT(picture, HasSubstr("a &amp; b.xyz: free, 100 Hz"));
  EXPECT_EQ(picture, read(folder / "two.svg"));
  EXPECT_EQ(folder.files(), (std::vector<std::string>{"a & b.xyz", "one.svg", "two.svg"}));
}

TEST(Plot, OfAWindowOfADryRunAndOfNothing) {
  const Folder folder;
  const std::string points = folder.write("a.xyz", xyz(walk(30, 2)));
  const std::string plot = folder / "a.svg";
  EXPECT_EQ(run({"engrave", points, "--plot", plot, "--plot-beats", "-3,5"}).status, 0);
  EXPECT_THAT(read(plot), HasSubstr(">-3</text>"));
  EXPECT_EQ(run({"engrave", points, "--plot", plot, "--dry"}).status, 0);
  EXPECT_THAT(read(plot), HasSubstr("speed, m/s"));
  EXPECT_EQ(run({"engrave", points, "--plot", plot, "--plot-beats", "5000,5010"}).status, 0);
  EXPECT_THAT(read(plot), Not(HasSubstr(">X</text>")));
  const std::string zero = folder.write("zero.xyz", "0 0 0\n");
  EXPECT_EQ(run({"engrave", zero, "--plot", plot}).status, 0);
}

TEST(Plot, BadRequestsAreRefusedBeforeAnythingMoves) {
  const Folder folder;
  const std::string points = folder.write("a.xyz", xyz(walk(5, 3)));
  const auto refused = [&](std::vector<std::string> options, const std::string& names) {
    options.insert(options.begin(), {"engrave", points});
    const auto before = folder.files();
    const Finished done = run(options);
    EXPECT_EQ(done.status, 2) << names;
    EXPECT_THAT(done.err, testing::MatchesRegex("error: [^\n]+: [^\n]+; [^\n]+\n"));
    EXPECT_THAT(done.err, HasSubstr(names));
    EXPECT_EQ(folder.files(), before);
  };
  const std::string plot = folder / "a.svg";
  refused({"--plot", folder / "a.png"}, "a.png");
  refused({"--plot", folder / "none/a.svg"}, "none");
  refused({"--plot", plot, "--board", "chip"}, "--plot");
  refused({"--plot", plot, "--board", "/dev/none", "--yes"}, "--plot");
  refused({"--plot-beats", "0,10"}, "--plot-beats");
  refused({"--plot", plot, "--plot-beats", "10,10"}, "--plot-beats 10,10");
  refused({"--plot", plot, "--plot-beats", "0,2001"}, "--plot-beats 0,2001");
  refused({"--plot", plot, "--plot-beats", "0"}, "plot-beats");
  refused({"--plot", plot, "--plot-beats", "0,x"}, "plot-beats");
}

TEST(HoldAt, BrakesGoesOnAndFiresEveryPointOnce) {
  const Folder folder;
  const std::string points = folder.write("a.xyz", xyz(walk(100, 4)));
  const Finished done =
      run({"engrave", points, "--hold-at", "30", "--plot", folder / "a.svg", "--json"});
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("\"missed\": 0"));
  EXPECT_THAT(done.out, HasSubstr("\"doubled\": 0"));
  // A second at 100 Hz, and the beats it takes to get going.
  const auto at = done.out.find("\"hold\": ");
  ASSERT_NE(at, std::string::npos);
  EXPECT_NEAR(std::stoi(done.out.substr(at + 8)), 100, 15);
  EXPECT_THAT(read(folder / "a.svg"), HasSubstr(">hold</text>"));
  EXPECT_EQ(run({"engrave", points, "--hold-at", "0"}).status, 2);
}

}  // namespace
}  // namespace lamplock::cli::test
