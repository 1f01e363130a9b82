// `lamplock jog`: keys in a terminal and from a pipe, with the virtual board.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <functional>
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

/// A machine in another process, which keeps running when the program under test ends.
class MovingMachine {
 public:
  MovingMachine() { listening = sim_.wait_for("listening"); }

  /// A step that takes 20 s, at 1 mm/s.
  std::vector<std::string> slow_step() const {
    return {"jog", "--board", port_, "--pendant", "none", "--step", "20", "--feed", "60"};
  }
  /// The machine's status, read by another program.
  std::string status() const {
    const int port = ::open(port_.c_str(), O_RDWR | O_NOCTTY);
    termios modes{};
    ::tcgetattr(port, &modes);
    ::cfmakeraw(&modes);
    ::tcsetattr(port, TCSANOW, &modes);
    pollfd watched{port, POLLIN, 0};
    char byte = 0;
    // A killed program has left the answer to its last query unread.
    constexpr int quiet_ms = 50;
    while (::poll(&watched, 1, quiet_ms) > 0 && ::read(port, &byte, 1) == 1) continue;
    EXPECT_EQ(::write(port, "?", 1), 1);
    std::string text;
    constexpr int max_ms = 20'000;
    while (text.find('>') == std::string::npos && ::poll(&watched, 1, max_ms) > 0 &&
           ::read(port, &byte, 1) == 1)
      text += byte;
    ::close(port);
    return text.substr(std::min(text.find('<'), text.size()));
  }
  double x() const {
    const std::string text = status(), field = "MPos:";
    const auto at = text.find(field);
    return at == std::string::npos ? -1 : std::strtod(text.c_str() + at + field.size(), nullptr);
  }

  bool listening = false;

 private:
  Folder folder_;
  std::string port_ = folder_ / "port";
  Running sim_{{"sim", "--pty", port_}};
};

/// Terminal modes that differ from the defaults, so that the comparison is meaningful.
termios unusual_modes() {
  InTerminal other({"--version"});
  termios modes = other.modes();
  other.finish();
  modes.c_iflag ^= static_cast<tcflag_t>(IXANY | ICRNL);
  modes.c_lflag |= static_cast<tcflag_t>(ECHONL | NOFLSH);
  modes.c_cc[VERASE] = 8;
  modes.c_cc[VMIN] = 3;
  return modes;
}

void expect_same_modes(const termios& now, const termios& before) {
  EXPECT_EQ(now.c_iflag, before.c_iflag);
  EXPECT_EQ(now.c_oflag, before.c_oflag);
  EXPECT_EQ(now.c_cflag, before.c_cflag);
  EXPECT_EQ(now.c_lflag, before.c_lflag);
  EXPECT_THAT(now.c_cc, testing::ElementsAreArray(before.c_cc));
}

/// Any end of the program ends the motion; the terminal, if it still exists, has its modes again.
TEST(JogAtItsEnd, the_machine_rests_and_the_terminal_is_restored) {
  const termios before = unusual_modes();
  struct End {
    const char* name;
    int status;
    std::function<void(InTerminal&)> act;
  };
  const std::vector<End> ends{{"Esc, then q", 0,
                               [](InTerminal& jog) {
                                 jog.type("\x1b");
                                 EXPECT_TRUE(jog.wait_for("| Idle |"));
                                 jog.type("q");
                               }},
                              {"Ctrl-C", 0, [](InTerminal& jog) { jog.type("\x03"); }},
                              {"SIGINT", 130, [](InTerminal& jog) { jog.send_signal(SIGINT); }},
                              {"SIGTERM", 143, [](InTerminal& jog) { jog.send_signal(SIGTERM); }},
                              {"SIGHUP", 129, [](InTerminal& jog) { jog.send_signal(SIGHUP); }},
                              {"hangup", 129, [](InTerminal& jog) { jog.hang_up(); }}};
  for (const End& end : ends) {
    SCOPED_TRACE(end.name);
    const MovingMachine machine;
    ASSERT_TRUE(machine.listening);
    InTerminal jog(machine.slow_step(), before);
    ASSERT_TRUE(jog.wait_for("| Idle |"));
    const termios meanwhile = jog.modes();
    EXPECT_EQ(meanwhile.c_lflag & static_cast<tcflag_t>(ICANON | ECHO | ISIG), 0u);
    jog.type("\x1b[C");
    ASSERT_TRUE(jog.wait_for("| Jog |"));
    end.act(jog);
    EXPECT_EQ(jog.finish().status, end.status);
    if (std::string(end.name) != "hangup") expect_same_modes(jog.modes(), before);
    EXPECT_THAT(machine.status(), HasSubstr("<Idle|"));
    const double at_rest = machine.x();
    EXPECT_GE(at_rest, 0);
    EXPECT_LT(at_rest, 20);
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    EXPECT_EQ(machine.x(), at_rest);
  }
}

/// The board detects the closed port.
TEST(JogAtItsEnd, a_program_that_is_killed_ends_its_step) {
  const MovingMachine machine;
  ASSERT_TRUE(machine.listening);
  InTerminal jog(machine.slow_step());
  ASSERT_TRUE(jog.wait_for("| Idle |"));
  jog.type("\x1b[C");
  ASSERT_TRUE(jog.wait_for("| Jog |"));
  jog.send_signal(SIGKILL);
  jog.finish();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  // On a computer with other work the simulated board is late.
  constexpr int max_waits = 30;
  for (int i = 0; i < max_waits && machine.status().find("<Idle|") == std::string::npos; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_THAT(machine.status(), HasSubstr("<Idle|"));
  const double at = machine.x();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(machine.x(), at);
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

TEST(JogCommand, from_a_pipe_ends_with_it_and_prints_json) {
  const Finished done = run({"jog", "--board", "virtual", "--pendant", "none", "--json"}, "+x");
  ASSERT_EQ(done.status, 0) << done.err;
  const auto report = nlohmann::json::parse(done.out);
  EXPECT_EQ(report["state"], "Idle");
  EXPECT_EQ(report["machine_mm"].size(), 3u);
  EXPECT_EQ(report["lines"], 0);
  EXPECT_EQ(report["pendant"], "");
}

/// The whole program with a pendant that umockdev simulates.
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
  EXPECT_THAT(done.out, HasSubstr("XHC HB04 was disconnected: stopped"));
  EXPECT_THAT(done.err, HasSubstr("error: XHC HB04: was disconnected; the machine was stopped"));
  EXPECT_FALSE(bench.shown().empty()) << "no position on its display";
}

TEST(JogCommand, refuses_impossible_options) {
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
  EXPECT_THAT(light.err, HasSubstr("m.toml:2: 'M3 S100': M3 may turn on a laser"));
}

}  // namespace
}  // namespace lamplock::cli::test
