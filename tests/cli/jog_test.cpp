// `lamplock jog`: keys in a terminal and from a pipe, with the virtual board.
#include <gmock/gmock.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/cli/program.hpp"
#include "tests/pendant/hid_bench.hpp"

namespace lamplock::cli::test {
namespace {

using testing::HasSubstr;

TEST(JogCommand, moves_by_keys_in_a_terminal) {
  InTerminal terminal({"jog", "--board", "virtual", "--pendant", "none", "--step", "0.5"});
  ASSERT_TRUE(terminal.wait_for("X 0.000  Y 0.000  Z 0.000  | Idle | continuous | no axis"));
  terminal.type("\x1b[C");
  ASSERT_TRUE(terminal.wait_for("X 0.500  Y 0.000"));
  terminal.type("m\x1b[6~x");
  ASSERT_TRUE(terminal.wait_for("Z -0.500  | Idle"));
  terminal.type("m");
  ASSERT_TRUE(terminal.wait_for("| step 0.5 mm | X |"));
  terminal.type("q");
  EXPECT_EQ(terminal.finish().status, 0);
}

/// Ctrl-C and Ctrl-D are keys.
TEST(JogCommand, every_way_out_ends_it) {
  for (const char* last : {"q", "\x03", "\x04"}) {
    InTerminal terminal({"jog", "--board", "virtual", "--pendant", "none"});
    ASSERT_TRUE(terminal.wait_for("| Idle |"));
    terminal.type(last);
    EXPECT_EQ(terminal.finish().status, 0);
  }
}

TEST(JogCommand, from_a_pipe_ends_with_it_and_tells_in_json) {
  const Finished done = run({"jog", "--board", "virtual", "--pendant", "none", "--json"}, "+x");
  ASSERT_EQ(done.status, 0) << done.err;
  const auto told = nlohmann::json::parse(done.out);
  EXPECT_EQ(told["state"], "Idle");
  EXPECT_EQ(told["machine_mm"].size(), 3u);
  EXPECT_EQ(told["lines"], 0);
  EXPECT_EQ(told["pendant"], "");
}

/// The whole program at a pendant that umockdev makes.
TEST(JogCommand, ends_when_its_pendant_is_unplugged) {
  using namespace std::chrono_literals;
  pendant::HidBench bench("10CE", "EB70");
  ::setenv("LD_PRELOAD", pendant::umockdev_library, 1);
  Running jog({"jog", "--board", "virtual", "--pendant", "hb04", "--mode", "continuous"});
  ::unsetenv("LD_PRELOAD");
  ASSERT_TRUE(jog.wait_for("XHC HB04 at /dev/hidraw0"));
  ASSERT_TRUE(jog.wait_for("| Idle |"));
  for (int i = 0; i < 200 && jog.out().find("| Jog |") == std::string::npos; ++i) {
    bench.send({4, 0, 0, 0x11, 1, 0x55});
    std::this_thread::sleep_for(30ms);
  }
  bench.unplug();
  const Finished done = jog.finish();
  EXPECT_EQ(done.status, 3);
  EXPECT_THAT(done.out, HasSubstr("| Jog | continuous | X |"));
  EXPECT_THAT(done.out, HasSubstr("XHC HB04 has gone: stopped"));
  EXPECT_THAT(done.err, HasSubstr("error: XHC HB04: has gone; the machine was stopped"));
  EXPECT_FALSE(bench.shown().empty()) << "its display shows the place";
}

TEST(JogCommand, refuses_what_cannot_be) {
  EXPECT_EQ(run({"jog", "--board", "/dev/no-such-port"}).status, 3);
  EXPECT_EQ(run({"jog", "--pendant", "mouse"}).status, 2);
  EXPECT_EQ(run({"jog", "--step", "0"}).status, 2);
  EXPECT_EQ(run({"jog", "--feed", "-5"}).status, 2);
  const Finished none = run({"jog", "--board", "virtual", "--pendant", "hb04"});
  EXPECT_EQ(none.status, 3);
  EXPECT_THAT(none.err, HasSubstr("error: --pendant hb04: is not plugged in"));
  const Folder folder;
  const std::string machine =
      folder.write("m.toml", "[pendant.macros.on]\nlines = [\"M3 S100\"]\n");
  const Finished light = run({"jog", "--machine", machine});
  EXPECT_EQ(light.status, 2);
  EXPECT_THAT(light.err, HasSubstr("m.toml:2: 'M3 S100': M3 may light a laser"));
}

}  // namespace
}  // namespace lamplock::cli::test
