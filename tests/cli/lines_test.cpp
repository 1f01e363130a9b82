// `--lines` and [lines] of a profile on a computer without lines: which file is used or refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/program.hpp"

namespace lamplock::cli {
namespace {

using test::Finished;
using test::Folder;
using test::run;
using testing::HasSubstr;

TEST(Lines, an_explicit_file_is_refused_by_a_simulated_board) {
  const Folder folder;
  const std::string model = folder.write("a.xyz", "0 0 0\n");
  for (const char* board : {"virtual", "chip"}) {
    const Finished refused =
        run({"engrave", model, "--board", board, "--lines", folder / "none.toml", "--yes"});
    EXPECT_EQ(refused.status, 2);
    EXPECT_THAT(refused.err, HasSubstr("--board"));
    EXPECT_EQ(test::lines(refused.err).size(), 1u) << refused.err;
  }
  EXPECT_EQ(run({"operate", "home", "--lines", folder / "none.toml"}).status, 2);
}

TEST(Lines, a_profile_may_name_them) {
  const Folder folder;
  const std::string profile = folder.write("m.toml", "[lines.estop]\nline = 'gpiochip4095:1'\n");
  const Finished shown = run({"lines", "--machine", profile});
  EXPECT_EQ(shown.status, 3);
  EXPECT_THAT(shown.err, HasSubstr("gpiochip4095"));
  // --lines overrides the profile.
  const std::string none = folder.write("none.toml", "debounce_ms = 5\n");
  EXPECT_EQ(run({"lines", "--machine", profile, "--lines", none}).status, 0);
  const std::string wrong = folder.write("w.toml", "[lines.stop]\nline = 'a'\n");
  const std::string model = folder.write("a.xyz", "0 0 0\n");
  EXPECT_THAT(run({"engrave", model, "--machine", wrong, "--yes"}).err,
              HasSubstr("unknown key 'stop'"));
  EXPECT_EQ(run({"engrave", model, "--machine", profile, "--yes"}).status, 0) << "simulated";
}

/// A command without the lines would ignore an e-stop on them.
TEST(Lines, every_command_of_a_real_board_uses_the_lines_of_its_profile) {
  const Folder folder;
  const std::string port = folder / "port";
  test::Running sim({"sim", "--pty", port});
  ASSERT_TRUE(sim.wait_for("listening"));
  const std::string profile = folder.write("m.toml", "[lines.estop]\nline = 'gpiochip4095:1'\n");
  const std::string points = folder.write("a.xyz", "0 0 0\n"), job = folder / "a.llj";
  ASSERT_EQ(run({"job", points, "-o", job}).status, 0);
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{"engrave", points, "--yes"},
                                             {"frame", points},
                                             {"send", job, "--yes"},
                                             {"send", folder.write("a.ngc", "G0 X1\n"), "--yes"},
                                             {"operate", "init"},
                                             {"console"},
                                             {"jog", "--pendant", "none"}}) {
    std::vector<std::string> arguments = command;
    arguments.insert(arguments.end(), {"--board", port, "--machine", profile});
    const Finished ended = run(arguments);
    EXPECT_EQ(ended.status, 3) << command[0] << ended.err;
    EXPECT_THAT(ended.err, HasSubstr("there is no such chip")) << command[0];
  }
}

TEST(Lines, every_line_of_the_file_is_opened) {
  const Folder folder;
  for (const char* role : {"estop", "interlock", "run"}) {
    const std::string file =
        folder.write("l.toml", std::string("[") + role + "]\nline = 'gpiochip4095:3'\n");
    const Finished shown = run({"lines", "--lines", file});
    EXPECT_EQ(shown.status, 3) << role;
    EXPECT_THAT(shown.err, HasSubstr("there is no such chip")) << role;
  }
  EXPECT_EQ(run({"lines", "reset"}).status, 2);
}

}  // namespace
}  // namespace lamplock::cli
