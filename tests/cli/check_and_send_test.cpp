// `lamplock check` and `lamplock send` judge the lines of a program alike, with the same text.
#include <gmock/gmock.h>

#include <array>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/cli/program.hpp"

namespace lamplock::cli::test {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Expects that both refuse a program with this text about this place, FILE:LINE or
/// FILE:LINE:COLUMN.
void expect_both_refuse(const std::string& program, const std::string& place,
                        const std::string& what) {
  const Folder folder;
  const std::string file = folder.write("p.ngc", program);
  const Finished checked = run({"check", file}), sent = run({"send", file, "--board", "virtual"});
  EXPECT_EQ(checked.status, 2) << program;
  EXPECT_EQ(sent.status, 2) << program;
  EXPECT_THAT(checked.out, HasSubstr(file + place + ":")) << program;
  EXPECT_THAT(sent.err, HasSubstr(file + place + ":")) << program;
  EXPECT_THAT(checked.out, HasSubstr(what)) << program;
  EXPECT_THAT(sent.err, HasSubstr(what)) << program;
}

TEST(CheckAndSend, RefuseTheSameBoardLines) {
  for (const std::string line : {"$J=G91 X1 F100", "$10=1", "$C", "$SLP", "$FOO", "$ j=x1", "$HXY",
                                 "$N0=G21", "$RST=*", "$32"})
    expect_both_refuse("G21\n" + line + "\nG4 P0.01\n", ":2",
                       "'" + line + "' must not be in a program");
  for (const std::string line : {"$", "$$", "$#", "$G", "$I", "$N", "$X", "$x", "$ G"}) {
    const Folder folder;
    const std::string file = folder.write("p.ngc", "G21\n" + line + "\nG4 P0.01\n");
    EXPECT_EQ(run({"check", file}).status, 0) << line;
    EXPECT_EQ(run({"send", file, "--board", "virtual"}).status, 0) << line;
  }
}

TEST(CheckAndSend, RefuseTheSameBytes) {
  for (const auto& [byte, name] :
       {std::pair{'\x18', "0x18"}, std::pair{'!', "0x21"}, std::pair{'~', "0x7E"},
        std::pair{'?', "0x3F"}, std::pair{'\x84', "0x84"}, std::pair{'\x7f', "0x7F"}}) {
    const std::string what = std::string("the byte ") + name + " outside of a comment";
    expect_both_refuse(std::string("G21\nG1 X1 F100") + byte + "\n", ":2", what);
    expect_both_refuse(std::string("G21\n$X") + byte + "\n", ":2", what);
    const Folder folder;
    const std::string file = folder.write("p.ngc", std::string("G4 P0.01 (a") + byte + ")\n");
    EXPECT_EQ(run({"check", file}).status, 0) << name;
    EXPECT_EQ(run({"send", file, "--board", "virtual"}).status, 0) << name;
  }
}

TEST(CheckAndSend, RefuseAFileWithoutALineToRun) {
  const Folder folder;
  for (const std::string text : {"\n", "(nothing)\n", "%\n; a\n%\n", " \t\n(a) (b)\n"}) {
    const std::string file = folder.write("p.ngc", text);
    for (const Finished& done : {run({"check", file}), run({"send", file, "--board", "virtual"})}) {
      EXPECT_EQ(done.status, 2) << text;
      EXPECT_THAT(done.err, HasSubstr("p.ngc: has no line to send; is this the right file?"));
    }
  }
}

/// A machine that sleeps does not answer.
TEST(CheckAndSend, SleepIsNeverSent) {
  const Folder folder;
  for (const std::string text : {"$SLP\n", "$X\n$ slp\n", "G4 P0.01\n$SLP\n"}) {
    const std::string file = folder.write("p.ngc", text);
    const Finished sent = run({"send", file, "--board", "virtual", "--ignore-errors"});
    EXPECT_EQ(sent.status, 2) << text;
    EXPECT_THAT(sent.err, HasSubstr("must not be in a program, nothing was sent; take it out"));
    EXPECT_EQ(run({"check", file}).status, 2) << text;
  }
}

/// Time, bounds and errors are those of all lines, as `send` runs them.
TEST(CheckAndSend, LinesAfterTheEndAreRun) {
  const Folder folder;
  for (const std::string end : {"M2", "M30"}) {
    const std::string before = "G21 G90\nG1 X10 F600\n", after = "G1 X-20 F600\nG4 P0.5\n";
    const auto seen = [&](const std::string& text) {
      const Finished done = run({"check", folder.write("p.ngc", text), "--json"});
      EXPECT_EQ(done.status, 0) << done.err;
      return nlohmann::json::parse(done.out);
    };
    const nlohmann::json whole = seen(before + end + "\n" + after);
    EXPECT_NEAR(whole["feed_mm"].get<double>(), 40, 1e-9);
    EXPECT_NEAR(whole["low_mm"][0].get<double>(), -20, 1e-9);
    EXPECT_NEAR(whole["time_s"].get<double>(),
                seen(before + "G4 P0\n" + after)["time_s"].get<double>(), 1e-3);
    EXPECT_EQ(whole["ended"], true);
    expect_both_refuse(before + end + "\nG1 X1 X2 F100\n", ":4", "the word occurs twice");
    expect_both_refuse(before + end + "\nG1 X60 F100\n", ":4", "X 60.000 mm is outside");
  }
}

}  // namespace
}  // namespace lamplock::cli::test
