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
  refused({"--plot", plot, "--plot-beats", "-5,9223372036854775807"}, "--plot-beats -5,");
  refused({"--plot", plot, "--plot-beats", "9223372036854775806,9223372036854775807"},
          "--plot-beats 9223372036854775806,");
  refused({"--plot", plot, "--plot-beats", "-9223372036854775808,0"}, "--plot-beats -9223");
  refused({"--plot", plot, "--plot-beats", "0"}, "plot-beats");
  refused({"--plot", plot, "--plot-beats", "0,x"}, "plot-beats");
  refused({"--plot", ""}, "--plot");
  refused({"--plot", plot, "--vcd", folder / "b/../a.svg"}, "--vcd and --plot");
}

TEST(HoldAt, APointThatTheJobDoesNotPassIsRefused) {
  const Folder folder;
  const std::string points = folder.write("a.xyz", xyz(walk(20, 3)));
  const auto refused = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"engrave", points, "--vcd", folder / "a.vcd", "--hold-at"});
    const auto before = folder.files();
    const Finished done = run(options);
    EXPECT_EQ(done.status, 2) << options.back();
    EXPECT_THAT(done.err, testing::MatchesRegex("error: --hold-at[^\n]*: [^\n]+; [^\n]+\n"));
    EXPECT_EQ(folder.files(), before);
  };
  for (const char* points_fired : {"0", "-1", "1.5", "20", "21", "5000000000"})
    refused({points_fired});
  refused({"5", "--from", "5"});
  refused({"20", "--from", "19"});
  EXPECT_EQ(run({"engrave", points, "--hold-at", "6", "--from", "5"}).status, 0);
  const std::string zero = folder.write("zero.xyz", "0 0 0\n");
  EXPECT_THAT(run({"engrave", zero, "--hold-at", "1"}).err, HasSubstr("leave it out"));
}

TEST(HoldAt, AJobThatEndedBeforeTheHoldIsReported) {
  const Folder folder;
  // At a point per millisecond the machine's report arrives after the last point.
  const std::string points = folder.write("a.xyz", xyz(walk(100, 3, 0.005)));
  int not_held = 0;
  for (const char* last : {"97", "98", "99"}) {
    const Finished done = run({"engrave", points, "--lamp", "1000", "--hold-at", last});
    EXPECT_EQ(done.status, 0);
    const bool held = done.err.find("holding for a second") != std::string::npos;
    EXPECT_NE(held, done.err.find("not held") != std::string::npos) << done.err;
    not_held += held ? 0 : 1;
  }
  EXPECT_GT(not_held, 0);
}

TEST(HoldAt, BrakesResumesAndFiresEveryPointOnce) {
  const Folder folder;
  const std::string points = folder.write("a.xyz", xyz(walk(100, 4)));
  const Finished done =
      run({"engrave", points, "--hold-at", "30", "--plot", folder / "a.svg", "--json"});
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("\"missed\": 0"));
  EXPECT_THAT(done.out, HasSubstr("\"doubled\": 0"));
  // A second at 100 Hz, and the beats of the restart.
  const auto at = done.out.find("\"hold\": ");
  ASSERT_NE(at, std::string::npos);
  EXPECT_NEAR(std::stoi(done.out.substr(at + 8)), 100, 15);
  EXPECT_THAT(read(folder / "a.svg"), HasSubstr(">hold</text>"));
  EXPECT_EQ(run({"engrave", points, "--hold-at", "0"}).status, 2);
}

}  // namespace
}  // namespace lamplock::cli::test
