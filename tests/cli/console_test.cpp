// `lamplock console`: lines from a pipe, and a terminal.
#include <gmock/gmock.h>

#include "tests/cli/program.hpp"

namespace lamplock::cli::test {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(ConsoleCommand, answers_and_ends_with_its_input) {
  const Finished done = run({"console", "--board", "virtual"}, "$$\n\n?\n$I");
  EXPECT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("$901=100.000\n"));
  EXPECT_THAT(done.out, HasSubstr("<Idle|MPos:0.000,0.000,0.000"));
  EXPECT_THAT(done.out, HasSubstr("[VER:"));
  EXPECT_EQ(run({"console"}, "").status, 0);
}

TEST(ConsoleCommand, ends_at_the_first_error) {
  const Finished wrong = run({"console"}, "$I\n$nonsense\n$$\n");
  EXPECT_EQ(wrong.status, 1);
  EXPECT_THAT(wrong.err, HasSubstr("error: line 2: error:3 no such $ command"));
  EXPECT_THAT(wrong.out, Not(HasSubstr("$901")));
  EXPECT_EQ(run({"console"}, ":nonsense\n").status, 2);
  const Finished loud = run({"console"}, "G0 X1 ! Y1\n");
  EXPECT_EQ(loud.status, 2);
  EXPECT_THAT(loud.err, HasSubstr("error: line 1: the byte 0x21"));
}

TEST(ConsoleCommand, in_a_terminal) {
  InTerminal terminal({"console", "--board", "virtual"});
  terminal.type("$nonsense\n");
  ASSERT_TRUE(terminal.wait_for("error:3 no such $ command"));
  terminal.type(":nothing\n");
  ASSERT_TRUE(terminal.wait_for("there are ?"));
  terminal.type(":status\n");
  ASSERT_TRUE(terminal.wait_for("<Idle|"));
  terminal.type("$901=50\n$$\n");
  ASSERT_TRUE(terminal.wait_for("$901=50.000"));
  terminal.type("\x04");
  EXPECT_EQ(terminal.finish().status, 0);
}

/// A simulated machine that homes has switches where its settings say.
TEST(ConsoleCommand, homes_the_simulated_machine) {
  const Folder folder;
  const std::string machine =
      folder.write("m.toml",
                   "homing = true\nhoming_direction = 1\nhoming_seek = 6000\nhoming_feed = 300\n"
                   "lamp_mode = 0\n");
  const Finished done = run({"console", "--machine", machine}, "?\n$H\n?\nG38.3 Z45 F6000\n");
  EXPECT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("<Alarm|"));
  EXPECT_THAT(done.out, HasSubstr("<Idle|MPos:-49.000,49.000,49.000|"));
  EXPECT_THAT(done.out, HasSubstr("[PRB:-49.000,49.000,45.000:0]"));
}

TEST(ConsoleCommand, without_a_board) {
  EXPECT_EQ(run({"console", "--board", "/dev/no-such-port"}, "$$\n").status, 3);
}

}  // namespace
}  // namespace lamplock::cli::test
