// The file of GPIO lines: its contents and its errors.
#include "host/gpio/line_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "host/error.hpp"
#include "host/gpio/line_address.hpp"
#include "host/gpio/read_line_table.hpp"
#include "tests/error_of.hpp"
#include "tests/paths.hpp"
#include "tests/scale.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::gpio {
namespace {

using namespace std::chrono_literals;
using test::error_of;
using testing::HasSubstr;

LineTable parse(const std::string& text) { return parse_line_table(text, "lines.toml"); }
std::string error(const std::string& text) {
  return error_of([&] { parse(text); });
}

TEST(LineTable, InputsAreClosedContactsToGroundAndPinsOfTheBoardOpenDrains) {
  const LineTable lines =
      parse("[estop]\nline = 'GPIO17'\n[interlock]\nline = 'gpiochip1:3'\n[run]\nline = 'RUN'\n");
  ASSERT_TRUE(lines.estop && lines.interlock && lines.run);
  EXPECT_EQ(lines.estop->place, "GPIO17");
  EXPECT_FALSE(lines.estop->active_low);
  EXPECT_EQ(lines.estop->bias, Bias::pull_up);
  EXPECT_FALSE(lines.interlock->active_low);
  EXPECT_EQ(lines.interlock->drive, Drive::push_pull);
  EXPECT_TRUE(lines.run->active_low);
  EXPECT_EQ(lines.run->drive, Drive::open_drain);
  EXPECT_FALSE(lines.door || lines.lamp || lines.bootsel);
  EXPECT_EQ(lines.debounce, 20ms);
  EXPECT_EQ(lines.interlock_beat, 0ms);
  EXPECT_TRUE(lines.guards());
  EXPECT_FALSE(parse("[run]\nline = 'RUN'\n").guards());
  EXPECT_FALSE(parse("").guards());
}

TEST(LineTable, ReadsStatedValues) {
  const LineTable lines = parse(
      "debounce_ms = 5\ninterlock_beat_ms = 50\n"
      "[door]\nline = 'D'\nactive_low = true\nbias = 'pull-down'\n"
      "[interlock]\nline = 'I'\nactive_low = true\n[lamp]\nline = 'L'\n");
  EXPECT_EQ(lines.debounce, 5ms);
  EXPECT_EQ(lines.interlock_beat, 50ms);
  EXPECT_TRUE(lines.door->active_low);
  EXPECT_EQ(lines.door->bias, Bias::pull_down);
  EXPECT_TRUE(lines.interlock->active_low);
}

TEST(LineTable, ErrorsNameTheLineAndARemedy) {
  EXPECT_THAT(error("[stop]\nline = 'a'"), HasSubstr("lines.toml:1: unknown key 'stop'"));
  EXPECT_THAT(error("[estop]\n"), HasSubstr("lines.toml:1: [estop] has no line"));
  EXPECT_THAT(error("[estop]\nline = 17"), HasSubstr("lines.toml:2: 'line' must be a text"));
  EXPECT_THAT(error("[estop]\nline = ''"), HasSubstr("'line' is empty"));
  EXPECT_THAT(error("estop = 'GPIO17'"), HasSubstr("'estop' must be a table"));
  EXPECT_THAT(error("[estop]\nline = 'a'\nbias = 'up'"), HasSubstr("unknown bias 'up'"));
  EXPECT_THAT(error("[estop]\nline = 'a'\nactive_low = 1"), HasSubstr("true or false"));
  EXPECT_THAT(error("[interlock]\nline = 'a'\nbias = 'none'"),
              HasSubstr("unknown key 'bias' of [interlock]"));
  EXPECT_THAT(error("[run]\nline = 'a'\nactive_low = false"), HasSubstr("of [run]; use line"));
  EXPECT_THAT(error("debounce_ms = 2000"), HasSubstr("a whole number, 0 to 1000"));
  EXPECT_THAT(error("debounce_ms = 1.5"), HasSubstr("whole number"));
  EXPECT_THAT(error("interlock_beat_ms = 50"), HasSubstr("add [interlock]"));
  EXPECT_THAT(error("[door]\nline = 'gpiochip0:4'\n[lamp]\nline = '/dev/gpiochip0:4'"),
              HasSubstr("[door] and [lamp] are both gpiochip0:4"));
  EXPECT_THAT(error("[door\n"), HasSubstr("lines.toml:"));
}

TEST(LineTable, MayBePartOfAMachineProfile) {
  const test::TemporaryFolder folder;
  const auto lines_of = [&](const std::string& text) {
    return read_machine_lines(folder.write("machine.toml", text));
  };
  const LineTable lines =
      lines_of("name = 'a'\n[lines]\ndebounce_ms = 5\n[lines.estop]\nline = 'GPIO17'\n[pendant]\n");
  ASSERT_TRUE(lines.estop);
  EXPECT_EQ(lines.estop->place, "GPIO17");
  EXPECT_EQ(lines.debounce, 5ms);
  EXPECT_FALSE(lines_of("name = 'a'\n").guards());
  EXPECT_THAT(error_of([&] { lines_of("[lines.stop]\nline = 'a'\n"); }),
              HasSubstr("machine.toml:1: unknown key 'stop'"));
  EXPECT_THAT(error_of([&] { lines_of("lines = 'a.toml'\n"); }), HasSubstr("must be a table"));
}

TEST(LineTable, TheExampleNamesEveryRole) {
  const LineTable lines = read_line_table(test::in_repository("examples/lines.toml"));
  EXPECT_TRUE(lines.estop && lines.door && lines.interlock && lines.lamp && lines.run &&
              lines.bootsel);
}

/// The library of TOML has assertions for these; they are refused as any other damage, at their
/// line.
TEST(LineTable, DamageThatReachesAssertionsIsRefusedAtItsLine) {
  for (const std::string bad : {"[+]", "[[)", "[.", "[\\", "a = [}", "a = {b = 1, c = [1,}"})
    EXPECT_THAT(error_of([&] { parse("debounce_ms = 5\n" + bad + "\n[run]\nline = 'RUN'\n"); }),
                testing::ContainsRegex(":2: .* is missing; correct the line"))
        << bad;
}

/// Damaged files are refused in one line or understood.
TEST(LineTable, RandomDamageIsRefusedOrUnderstood) {
  const std::string good =
      "debounce_ms = 5\n[estop]\nline = 'GPIO17'\nbias = 'pull-up'\n[interlock]\nline = "
      "'gpiochip0:3'\nactive_low = true\n[run]\nline = 'RUN'\n";
  std::mt19937_64 random(1);
  for (int i = 0; i < test::scaled(3000); ++i) {
    std::string text = good;
    for (int n = std::uniform_int_distribution(1, 4)(random); n > 0; --n) {
      const auto at = std::uniform_int_distribution<std::size_t>(0, text.size() - 1)(random);
      const auto byte = static_cast<char>(std::uniform_int_distribution(0, 255)(random));
      if (n % 2 == 0)
        text.erase(at, 3);
      else
        text[at] = byte;
      if (text.empty()) break;
    }
    try {
      parse(text);
    } catch (const Error& error) {
      EXPECT_EQ(error.exit(), Exit::bad_input);
    }
  }
}

TEST(LineAddress, IsANameOrAChipAndANumber) {
  EXPECT_EQ(parse_line_address("GPIO17").name, "GPIO17");
  EXPECT_EQ(parse_line_address("gpiochip0:17").chip, "/dev/gpiochip0");
  EXPECT_EQ(parse_line_address("gpiochip0:17").number, 17u);
  EXPECT_EQ(parse_line_address("/tmp/chip:0").chip, "/tmp/chip");
  EXPECT_EQ(parse_line_address("usb:in:a").name, "usb:in:a");
  EXPECT_EQ(parse_line_address(":5").name, ":5");
  EXPECT_EQ(parse_line_address("gpiochip0:-1").name, "gpiochip0:-1");
  EXPECT_THAT(error_of([] { parse_line_address(""); }), HasSubstr("the name is empty"));
}

TEST(LineAddress, ChipsAreListedByNumber) {
  const test::TemporaryFolder folder;
  for (const char* name : {"gpiochip10", "gpiochip2", "gpiochip", "gpiochipx", "tty0"})
    folder.write(name, "");
  const std::vector<std::string> files = chip_files(folder.file("").parent_path().string());
  ASSERT_EQ(files.size(), 2u);
  EXPECT_TRUE(files[0].ends_with("/gpiochip2"));
  EXPECT_TRUE(files[1].ends_with("/gpiochip10"));
  EXPECT_TRUE(chip_files("/no/such/folder").empty());
}

TEST(LineAddress, LinesAreSearchedWithoutRequestingThem) {
  const std::vector<ChipInfo> chips{
      {.file = "/dev/gpiochip0", .lines = {{0, "FREE", "", false}, {1, "TAKEN", "led", true}}},
      {.file = "/dev/gpiochip1", .problem = "may not be opened"}};
  EXPECT_NO_THROW(check_free(chips, "FREE"));
  EXPECT_NO_THROW(check_free(chips, "gpiochip0:0"));
  const auto error = [&](const char* place) {
    try {
      check_free(chips, place);
    } catch (const Error& thrown) {
      return std::string(thrown.what());
    }
    return std::string();
  };
  EXPECT_THAT(error("TAKEN"), HasSubstr("is used by led"));
  EXPECT_THAT(error("gpiochip0:1"), HasSubstr("is used by led"));
  EXPECT_THAT(error("gpiochip0:2"), HasSubstr("there is no such line"));
  EXPECT_THAT(error("gpiochip9:3"), HasSubstr("there is no such chip"));
  EXPECT_THAT(error("gpiochip1:3"), HasSubstr("chips that may be opened"));
  EXPECT_THAT(error("OTHER"), HasSubstr("chips that may be opened"))
      << "the line may be on that chip";
}

TEST(LineAddress, ErrorsAreOneLineWithARemedy) {
  EXPECT_THAT(chip_error("/dev/gpiochip0", EACCES).what(), HasSubstr("rule for lines"));
  EXPECT_THAT(chip_problem("/dev/gpiochip0", EPERM), HasSubstr("60-lamplock.rules"));
  EXPECT_EQ(chip_error("/dev/gpiochip9", ENOENT).exit(), Exit::no_device);
  EXPECT_THAT(request_error("GPIO4", EBUSY).what(), HasSubstr("used by another program"));
  EXPECT_EQ(request_error("GPIO4", EINVAL).exit(), Exit::bad_input);
  EXPECT_TRUE(has_no_edges(ENXIO) && has_no_edges(ENODEV));
  EXPECT_FALSE(has_no_edges(EBUSY) || has_no_edges(EINVAL)) << "these must not be requested again";
  EXPECT_EQ(no_line_error("GPIO99").exit(), Exit::bad_input);
  EXPECT_EQ(no_line_error("GPIO99", "/dev/gpiochip0").exit(), Exit::no_device);
}

}  // namespace
}  // namespace lamplock::gpio
