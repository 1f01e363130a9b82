// `lamplock console`: lines from a pipe, and a terminal.
#include <gmock/gmock.h>

#include <chrono>
#include <csignal>
#include <string>
#include <thread>

#include "tests/cli/program.hpp"
#include "tests/cli/screen.hpp"

namespace lamplock::cli::test {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using testing::HasSubstr;
using testing::Not;

/// Moves there and back, as a user pastes them.
std::string pasted_moves(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += i % 2 == 0 ? "G1 X40 F600\n" : "G1 X-40\n";
  return text;
}

/// A board at a port and a console connected to it.
struct ConsoleToPort {
  ConsoleToPort() : terminal({"console", "--board", address()}) {}

  std::string address() const {
    if (!sim.wait_for("Ctrl-C")) return {};
    const std::string text = sim.out(), intro = "listening on ";
    const auto at = text.rfind(intro + "127") + intro.size();
    return text.substr(at, text.find('\n', at) - at);
  }

  Running sim{{"sim", "--tcp", "127.0.0.1:0"}};
  InTerminal terminal;
};

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

/// A pause in the last line ends it; of other pauses the user sees the line.
TEST(ConsoleCommand, a_pause_of_a_script) {
  EXPECT_EQ(run({"console", "--board", "virtual"}, "G0X1\nM0\n").status, 0);
  EXPECT_EQ(run({"console", "--board", "virtual"}, "M0\n~\nG0X1\n").status, 0);
  Running waiting({"console", "--board", "virtual"}, "G0X1\nM0\nG0X2\n");
  EXPECT_TRUE(waiting.wait_for("the machine waits in line 2"));
  waiting.interrupt();
  waiting.finish();
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

/// The terminal buffers 4 KB of lines and delivers them one at a time.
TEST(ConsoleCommand, a_hold_overtakes_pasted_lines) {
  ConsoleToPort console;
  InTerminal& terminal = console.terminal;
  terminal.type("?\n");
  ASSERT_TRUE(terminal.wait_for("<Idle|"));
  terminal.type(pasted_moves(1000));
  ASSERT_TRUE(terminal.wait_for("ok"));
  const auto start = Clock::now();
  terminal.type(":hold\n");
  std::this_thread::sleep_for(300ms);
  terminal.type("?\n");
  ASSERT_TRUE(terminal.wait_for("<Hold:"));
  EXPECT_LT(Clock::now() - start, 1s);
  terminal.type(":reset\n");
  ASSERT_TRUE(terminal.wait_for("Grbl"));
  terminal.type("\x04");
  const Finished left = terminal.finish();
  EXPECT_EQ(left.status, 0);
  EXPECT_THAT(left.out, Not(HasSubstr("not sent"))) << "a reset discards the lines";
}

TEST(ConsoleCommand, a_hold_pasted_after_lines_stops_them) {
  ConsoleToPort console;
  InTerminal& terminal = console.terminal;
  terminal.type("?\n");
  ASSERT_TRUE(terminal.wait_for("<Idle|"));
  terminal.type(pasted_moves(20) + "!\n");
  ASSERT_TRUE(terminal.wait_for("typed lines that wait for ~"));
  std::this_thread::sleep_for(300ms);
  terminal.type("?\n");
  ASSERT_TRUE(terminal.wait_for("|MPos:"));
  terminal.type("\x04");
  EXPECT_THAT(terminal.finish().out, Not(HasSubstr("<Run|")));
}

TEST(ConsoleCommand, ctrl_c_overtakes_pasted_lines) {
  ConsoleToPort console;
  InTerminal& terminal = console.terminal;
  terminal.type("?\n");
  ASSERT_TRUE(terminal.wait_for("<Idle|"));
  terminal.type(pasted_moves(3000));
  ASSERT_TRUE(terminal.wait_for("ok"));
  const auto start = Clock::now();
  terminal.type("\x03");
  EXPECT_EQ(terminal.finish().status, 128 + SIGINT);
  EXPECT_LT(Clock::now() - start, 3s) << "the moves take hours";
}

TEST(ConsoleCommand, reports_how_many_pasted_lines_were_not_sent) {
  InTerminal terminal({"console", "--board", "virtual"});
  terminal.type("?\n");
  ASSERT_TRUE(terminal.wait_for("<Idle|"));
  terminal.type(pasted_moves(100) + "\x04");
  const Finished left = terminal.finish();
  EXPECT_EQ(left.status, 0);
  EXPECT_THAT(left.out, HasSubstr("typed lines that were not sent: "));
}

/// What the user sees, without the spaces at line ends.
std::vector<std::string> seen(InTerminal& terminal, Screen& screen) {
  screen.write(terminal.watch(300ms));
  return screen.lines();
}

TEST(ConsoleCommand, edits_and_recalls_lines_below_the_replies) {
  Screen screen(80, 30, Screen::Resizing::wraps);
  InTerminal terminal({"console", "--board", "virtual"});
  ASSERT_TRUE(terminal.wait_for("Grbl 1.1h"));
  terminal.type("$nonsnse");
  terminal.type("\x1b[D\x1b[D\x1b[De\n");  // left, three times
  ASSERT_TRUE(terminal.wait_for("error:3 no such $ command"));
  terminal.type(":status\n");
  ASSERT_TRUE(terminal.wait_for("<Idle|"));
  terminal.type("\x1b[A\x1b[A");  // up, up
  const auto lines = seen(terminal, screen);
  ASSERT_GE(lines.size(), 6u);
  EXPECT_THAT(lines[0], testing::StartsWith("keys: "));
  EXPECT_EQ(lines[2], "> $nonsense");
  EXPECT_THAT(lines[3], HasSubstr("error:3"));
  EXPECT_EQ(lines[4], "> :status");
  EXPECT_THAT(lines[5], testing::StartsWith("<Idle|"));
  EXPECT_EQ(lines.back(), "> $nonsense");
  terminal.type("\x15help\n");  // Ctrl-U
  ASSERT_TRUE(terminal.wait_for(":feed"));
  EXPECT_EQ(seen(terminal, screen).back(), ">");
  EXPECT_EQ(screen.unknown(), "");
  terminal.type("\x04");
  EXPECT_EQ(terminal.finish().status, 0);
}

/// Replies of a moving machine arrive while the user types.
TEST(ConsoleCommand, replies_do_not_disturb_the_line_that_is_typed) {
  Screen screen(40, 30, Screen::Resizing::wraps);
  ConsoleToPort console;
  InTerminal& terminal = console.terminal;
  terminal.resize(40);
  ASSERT_TRUE(terminal.wait_for("> "));
  terminal.type("G1 X1 F60\nG1 X2\nG1 X0\n");
  std::string typed = "(a line that is longer than the terminal is wide ";
  terminal.type(typed);
  for (int i = 0; i < 4; ++i) {
    screen.write(terminal.watch(150ms));
    terminal.type("?");
    typed += "?";
  }
  EXPECT_EQ(seen(terminal, screen).back(), "> " + typed);
  terminal.type("\x03");
  EXPECT_EQ(terminal.finish().status, 130);
}

/// A machine that moves for minutes, and a line that is half typed.
struct HalfTyped : ConsoleToPort {
  HalfTyped() {
    EXPECT_TRUE(terminal.wait_for("> "));
    terminal.type("G1 X40 F60\n");
    EXPECT_TRUE(terminal.wait_for("ok"));
    terminal.type("G0 X");
  }
  /// What the machine does, by a real-time key.
  bool is_in(const std::string& state) {
    for (int i = 0; i < 20; ++i) {
      terminal.type("?");
      if (!terminal.wait_for("<")) return false;
      const std::string bytes = terminal.watch(50ms);
      screen.write(bytes);
      if (bytes.find("<" + state) != std::string::npos) return true;
    }
    return false;
  }

  Screen screen{80, 60, Screen::Resizing::wraps};
};

TEST(ConsoleCommand, realtime_keys_act_while_a_line_is_typed) {
  HalfTyped console;
  Screen& screen = console.screen;
  InTerminal& terminal = console.terminal;
  ASSERT_TRUE(console.is_in("Run|"));
  terminal.type("!");
  ASSERT_TRUE(terminal.wait_for("hold; ~ resumes"));
  ASSERT_TRUE(console.is_in("Hold:"));
  // Keys whose sequences end in '~' resume nothing.
  for (const char* key : {"\x1b[5~", "\x1b[6~", "\x1b[3~", "\x1b[15~", "\x1b[1;5C"})
    terminal.type(key);
  EXPECT_TRUE(console.is_in("Hold:"));
  terminal.type("~");
  ASSERT_TRUE(console.is_in("Run|"));
  terminal.type("\x1b!");  // Esc before it
  ASSERT_TRUE(console.is_in("Hold:"));
  EXPECT_EQ(seen(terminal, screen).back(), "> G0 X") << "the line is kept";
  terminal.type("\x18");
  ASSERT_TRUE(terminal.wait_for("Grbl"));
  EXPECT_EQ(seen(terminal, screen).back(), "> G0 X");
  terminal.type("\x15G4 P0 (wow! ~)\n");
  EXPECT_TRUE(terminal.wait_for("ok"));
  EXPECT_EQ(screen.unknown(), "");
  terminal.type("\x03");
  EXPECT_THAT(terminal.finish().out, Not(HasSubstr("error: line")));
}

TEST(ConsoleCommand, a_stop_at_the_end_of_a_line_acts_and_the_rest_is_discarded) {
  HalfTyped console;
  InTerminal& terminal = console.terminal;
  terminal.type("5 :hold\n");
  ASSERT_TRUE(terminal.wait_for("hold; 'G0 X5' was not sent; ~ resumes"));
  EXPECT_TRUE(console.is_in("Hold:"));
  terminal.type("hold\n");
  EXPECT_TRUE(terminal.wait_for("unknown word 'hold'; did you mean ':hold'?"));
  terminal.type("hlep\n");
  EXPECT_TRUE(terminal.wait_for("did you mean 'help'?"));
  terminal.type("\x03");
  EXPECT_EQ(terminal.finish().status, 130);
}

/// A simulated machine that homes has its switches at the places of its settings.
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
