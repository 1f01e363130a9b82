// `lamplock chip`: images, scripts, traces, profiles, ports.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <thread>

#include "tests/chip/tiny_image.hpp"
#include "tests/cli/program.hpp"
#include "tests/paths.hpp"

namespace lamplock::cli::test {
namespace {

using lamplock::test::pin_image;
using lamplock::test::uart_image;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::Not;

std::string bytes(const std::vector<std::uint8_t>& image) { return {image.begin(), image.end()}; }

/// Everything that a run prints, without the wall-clock time.
nlohmann::json summary(const Finished& run) {
  nlohmann::json json = nlohmann::json::parse(run.out);
  json.erase("wall");
  return json;
}

TEST(Chip, runs_a_plain_binary_to_a_time) {
  const Folder folder;
  const std::string image = folder.write("pins.bin", bytes(pin_image()));
  const Finished done = run({"chip", image, "--until", "30ms", "--freq"});
  EXPECT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("simulated 0.03"));
  EXPECT_THAT(done.out, HasSubstr("clk_sys   6.5 MHz"));
  // 6.5 MHz by 65; the first period is longer by the 12 cycles from the store to CC, which raises
  // the pin, to the one that starts the counter (LDM 3, CMP 1, B 1, STR 2 and 3 wait states, B 2).
  const std::regex line(
      "gpio25 +([0-9.]+) kHz on average from the first to the last of ([0-9]+) rising");
  std::smatch found;
  ASSERT_TRUE(std::regex_search(done.out, found, line)) << done.out;
  const double periods = std::stod(found[2]) - 1;
  EXPECT_GT(periods, 2000);
  EXPECT_NEAR(std::stod(found[1]), 6500 * periods / (65 * periods + 12), 1e-6);
}

TEST(Chip, runs_a_uf2_file_the_same_way) {
  const Folder folder;
  const std::string bin = folder.write("pins.bin", bytes(pin_image()));
  const std::string uf2 = folder.write("pins.uf2", lamplock::test::uf2_file(pin_image()));
  const Finished one = run({"chip", bin, "--until", "20ms", "--json"});
  const Finished two = run({"chip", uf2, "--until", "20ms", "--json"});
  ASSERT_EQ(one.status, 0) << one.err;
  EXPECT_GT(summary(one)["pins"]["gpio25"]["rises"], 100);
  EXPECT_EQ(summary(one), summary(two));
}

TEST(Chip, ends_with_its_script) {
  const Folder folder;
  const std::string image = folder.write("pins.bin", bytes(pin_image()));
  const std::string script = folder.write(
      "t.script",
      "at 20ms set gpio8 1\nexpect gpio9 rise within 3cycles..10cycles of gpio8 rise\n");
  const Finished passed = run({"chip", image, "--script", script, "--json"});
  EXPECT_EQ(passed.status, 0) << passed.err;
  EXPECT_EQ(summary(passed)["script"]["passed"], true);
}

TEST(Chip, reports_in_one_line_what_was_not_as_expected) {
  const Folder folder;
  const std::string image = folder.write("pins.bin", bytes(pin_image()));
  const std::string script =
      folder.write("t.script", "at 20ms\n\nexpect gpio25 edges 10..20 in 1ms\n");
  const Finished failed =
      run({"chip", image, "--script", script, "--json", "--vcd", folder / "a.vcd"});
  EXPECT_EQ(failed.status, 1);
  EXPECT_THAT(failed.err,
              HasSubstr("error: " + script +
                        ":3: expected gpio25 edges 10..20 in 1ms, seen: 200, at 21 ms; "));
  EXPECT_EQ(summary(failed)["script"]["line"], 3);
  EXPECT_EQ(summary(failed)["script"]["at_ps"], 21'000'000'000);
  EXPECT_THAT(read(folder / "a.vcd"), HasSubstr("gpio25"));
}

TEST(Chip, a_script_that_is_not_over_in_time_has_not_passed) {
  const Folder folder;
  const std::string image = folder.write("pins.bin", bytes(pin_image()));
  const std::string script = folder.write("t.script", "wait gpio9 rise within 1s\n");
  const Finished failed = run({"chip", image, "--script", script, "--until", "25ms"});
  EXPECT_EQ(failed.status, 1);
  EXPECT_THAT(failed.err,
              HasSubstr(":1: expected gpio9 rise within 1s, seen: not complete yet (--until "
                        "25 ms reached), at 25 ms; "));
}

// The ROM's first steps take longer than 5 ms: the program in progress does not matter.
TEST(Chip, the_limit_is_named_and_is_the_time_of_the_failure) {
  const Folder folder;
  const std::string image = folder.write("pins.bin", bytes(pin_image()));
  const std::string script = folder.write("t.script", "wait gpio9 rise within 1s\n");
  const Finished failed = run({"chip", image, "--script", script, "--until", "5ms", "--json"});
  EXPECT_EQ(failed.status, 1);
  EXPECT_THAT(failed.err, HasSubstr("ended     --until 5 ms reached\n"));
  EXPECT_THAT(failed.err, HasSubstr("(--until 5 ms reached), at 5 ms; "));
  EXPECT_EQ(summary(failed)["ended"], "until");
  EXPECT_EQ(summary(failed)["script"]["at_ps"], 5'000'000'000);
}

TEST(Chip, a_script_without_until_has_a_limit) {
  const Folder folder;
  // wfi, again
  const std::vector<std::uint8_t> asleep = lamplock::test::tiny_image({0xbf30, 0xe7fd}, {});
  const std::string image = folder.write("asleep.bin", bytes(asleep));
  const std::string script = folder.write("t.script", "at 100s\nend\n");
  const Finished failed = run({"chip", image, "--script", script, "--json"});
  EXPECT_EQ(failed.status, 1);
  EXPECT_THAT(failed.err,
              HasSubstr(":1: expected at 100 s, seen: not complete yet (default limit of a "
                        "script reached, 60 s), at 60 s; "));
  EXPECT_EQ(summary(failed)["ended"], "default_limit");
}

TEST(Chip, sigterm_ends_it_with_a_summary_and_status_143) {
  const Folder folder;
  const std::string image = folder.write("pins.bin", bytes(pin_image()));
  const std::string script = folder.write("t.script", "wait gpio9 rise within 1000s\n");
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{}, std::vector<std::string>{"--script", script}}) {
    std::vector<std::string> all{"chip", image, "--uart", "pty"};
    all.insert(all.end(), more.begin(), more.end());
    Running running(all);
    ASSERT_TRUE(running.wait_for("UART0 is "));
    running.terminate();
    const Finished ended = running.finish();
    EXPECT_EQ(ended.status, 143);
    EXPECT_THAT(ended.out, HasSubstr("ended     SIGTERM\n"));
  }
}

TEST(Chip, wrong_use_ends_with_status_2) {
  const Folder folder;
  const std::string image = folder.write("pins.bin", bytes(pin_image()));
  const auto refused = [&](const std::vector<std::string>& arguments, const std::string& what) {
    std::vector<std::string> all{"chip"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const auto before = folder.files();
    const Finished wrong = run(all);
    EXPECT_EQ(wrong.status, 2);
    EXPECT_THAT(wrong.err, MatchesRegex("error: [^\n]+: [^\n]+; [^\n]+\n"));
    EXPECT_THAT(wrong.err, HasSubstr(what));
    EXPECT_EQ(folder.files(), before);
  };
  refused({}, "IMAGE");
  refused({folder / "none.uf2"}, "none.uf2");
  for (const char* const port : {"foo", "foo:bar", "127.0.0.1:99999"})
    refused({image, "--gdb", port}, std::string("--gdb ") + port);
  refused({folder.write("bad.uf2", "UF2\n")}, "bad.uf2");
  const std::string is_folder = folder.path().string() + ": not a file; give a file";
  refused({folder.path().string()}, is_folder);
  refused({image, "--script", folder.path().string()}, is_folder);
  refused({image, "--until", "soon"}, "'soon' is not a time");
  refused({image, "--until", "1ms", "--script", folder / "none"}, "none: no such file");
  refused({image, "--script", folder.write("t.script", "set gpio77 1\n")},
          "t.script:1: 'gpio77' is not a pin; pins are gpio0 to gpio29");
  refused({image, "--until", "1ms", "--vcd", folder / "none/a.vcd"}, "none/a.vcd");
  refused({image, "--until", "1ms", "--flash-size", "3"}, "--flash-size");
}

TEST(Chip, a_terminal_or_port_that_cannot_be_opened_ends_with_status_3) {
  const Folder folder;
  const std::string image = folder.write("pins.bin", bytes(pin_image()));
  const Running first({"chip", image, "--gdb", "0"});
  ASSERT_TRUE(first.wait_for("target remote 127.0.0.1:"));
  const std::string said = first.out();
  const std::size_t at = said.find("127.0.0.1:");
  const std::string taken = said.substr(at, said.find('\'', at) - at);
  for (const std::string& option : {"--gdb=" + taken, "--pty=" + folder / "none/link"}) {
    const Finished failed = run({"chip", image, option, "--until", "1ms"});
    EXPECT_EQ(failed.status, 3) << failed.err;
    EXPECT_THAT(failed.err, HasSubstr("cannot be opened"));
  }
}

TEST(Chip, two_runs_are_the_same_with_and_without_traces) {
  const Folder folder;
  const std::string image = folder.write("pins.bin", bytes(pin_image()));
  const std::string script = folder.write("t.script",
                                          "at 20ms pulse gpio8 3us every 7us times 90\n"
                                          "expect gpio9 rises 89..90 in 1ms\nend\n");
  const std::vector<std::string> plain{"chip", image, "--script", script, "--json"};
  std::vector<std::string> traced = plain;
  traced.insert(traced.end(), {"--vcd", folder / "a.vcd", "--profile", folder / "a.txt"});
  const Finished one = run(plain), two = run(plain), three = run(traced);
  ASSERT_EQ(one.status, 0) << one.err;
  EXPECT_EQ(summary(one), summary(two));
  EXPECT_EQ(summary(one), summary(three));
  const std::string vcd = read(folder / "a.vcd"), profile = read(folder / "a.txt");
  ASSERT_EQ(run(traced).status, 0);
  EXPECT_EQ(read(folder / "a.vcd"), vcd);
  EXPECT_EQ(read(folder / "a.txt"), profile);
}

TEST(Chip, the_profile_has_every_cycle) {
  const Folder folder;
  const std::string image = folder.write("pins.bin", bytes(pin_image()));
  const Finished done =
      run({"chip", image, "--until", "20ms", "--json", "--profile", folder / "a.txt"});
  ASSERT_EQ(done.status, 0) << done.err;
  std::uint64_t core0 = 0;
  for (const std::string& line : lines(read(folder / "a.txt"))) {
    EXPECT_THAT(line, MatchesRegex("core[01](;[^;]+)+ [0-9]+"));
    if (line.starts_with("core0")) core0 += std::stoull(line.substr(line.rfind(' ')));
  }
  EXPECT_EQ(core0, summary(done)["cycles"][0]);
  EXPECT_THAT(done.err, HasSubstr("function (by itself)"));
}

TEST(Chip, shows_what_the_uart_sends) {
  const Folder folder;
  const std::string image = folder.write("uart.bin", bytes(uart_image()));
  const std::string script = folder.write("t.script",
                                          "at 20ms uart0 send \"hello, chip\\n\"\n"
                                          "expect uart0 \"chip\\n\" within 5ms\n");
  const Finished done = run({"chip", image, "--script", script, "--uart", "-"});
  EXPECT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("hello, chip\n"));
}

TEST(Chip, shows_what_the_second_uart_sends) {
  const Folder folder;
  const std::string image = folder.write("uart.bin", bytes(uart_image(true)));
  const std::string script = folder.write("t.script",
                                          "at 20ms uart1 send \"hello, chip\\n\"\n"
                                          "expect uart1 \"chip\\n\" within 5ms\n");
  const Finished done = run({"chip", image, "--script", script, "--uart1", "-"});
  EXPECT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("hello, chip\n"));
  EXPECT_THAT(run({"chip", image, "--script", script, "--uart", "-"}).out,
              Not(HasSubstr("hello, chip\n")));
}

TEST(Chip, has_its_uart_on_a_terminal) {
  const Folder folder;
  const std::string image = folder.write("uart.bin", bytes(uart_image()));
  const std::string port = folder / "port";
  Running running({"chip", image, "--uart", port, "--json"});
  ASSERT_TRUE(running.wait_for("UART0 is " + port));
  const int terminal = ::open(port.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
  ASSERT_GE(terminal, 0);
  // The image reads as soon as the ROM has started it; earlier bytes are lost.
  std::string heard;
  std::array<char, 64> bytes{};
  for (int i = 0; i < 1000 && heard.find('!') == std::string::npos; ++i) {
    EXPECT_EQ(::write(terminal, "!", 1), 1);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    const ssize_t count = ::read(terminal, bytes.data(), bytes.size());
    if (count > 0) heard.append(bytes.data(), static_cast<std::size_t>(count));
  }
  ::close(terminal);
  EXPECT_THAT(heard, HasSubstr("!"));
  running.interrupt();
  EXPECT_EQ(running.finish().status, 0);
  EXPECT_FALSE(std::filesystem::exists(port));
}

#ifdef LAMPLOCK_HAS_FIRMWARE
TEST(Chip, the_use_of_the_flash_has_the_lines_of_the_program) {
  const Folder folder;
  const Finished done = run({"chip", lamplock::test::in_build("lamplock-rp2040.uf2"), "--until",
                             "20ms", "--json", "--flash-use", folder / "a.txt"});
  ASSERT_EQ(done.status, 0) << done.err;
  const std::vector<std::string> rows = lines(read(folder / "a.txt"));
  ASSERT_GT(rows.size(), 100u);
  EXPECT_EQ(rows[0], "# address visits misses");
  for (std::size_t i = 1; i < rows.size(); ++i)
    EXPECT_THAT(rows[i], MatchesRegex("0x10[0-9a-f]{6} [1-9][0-9]* [0-9]+"));
}

TEST(Chip, asks_the_firmware_over_usb) {
  const Folder folder;
  const std::string script = folder.write("t.script",
                                          "wait usb within 1s\nafter 20ms\nusb send \"$I\\n\"\n"
                                          "expect usb \"VER:\" within 20ms\n"
                                          "expect usb \"ok\\r\\n\" within 20ms\n"
                                          "expect gpio25 frequency 1MHz +-0.1% in 1ms\n");
  const Finished done =
      run({"chip", lamplock::test::in_build("lamplock-rp2040.uf2"), "--script", script, "--json"});
  EXPECT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(summary(done)["usb_violations"], nlohmann::json::array());
  EXPECT_EQ(summary(done)["clocks_hz"]["clk_sys"], 125'000'000);
}
#endif

}  // namespace
}  // namespace lamplock::cli::test
