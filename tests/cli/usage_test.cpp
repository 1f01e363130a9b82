// Help texts, and errors of wrong usage.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "host/version.hpp"
#include "shared/wire/messages.hpp"
#include "tests/cli/program.hpp"

namespace lamplock::cli::test {
namespace {

using testing::HasSubstr;

class CommandHelp : public testing::TestWithParam<std::string> {};

TEST_P(CommandHelp, has_a_help_text_with_an_example) {
  const Finished help = run({GetParam(), "--help"});
  EXPECT_EQ(help.status, 0);
  EXPECT_EQ(help.err, "");
  EXPECT_THAT(help.out, HasSubstr("Usage: lamplock " + GetParam()));
  EXPECT_THAT(help.out, HasSubstr("Example:\n  lamplock "));
  EXPECT_THAT(help.out, HasSubstr("lamplock " + GetParam() + " "));
}

INSTANTIATE_TEST_SUITE_P(all, CommandHelp,
                         testing::Values("example", "points", "order", "job", "send", "engrave",
                                         "frame", "compare", "sim", "chip", "bench", "check",
                                         "settings", "console", "raster", "estimate", "material",
                                         "serve", "watch"),
                         [](const auto& test) { return test.param; });

TEST(Usage, help_lists_every_command) {
  const Finished help = run({"--help"});
  EXPECT_EQ(help.status, 0);
  for (const char* command :
       {"example", "points", "order", "job", "send", "engrave", "frame", "compare", "sim", "chip",
        "bench", "check", "settings", "console", "raster", "estimate", "material", "--version"})
    EXPECT_THAT(help.out, HasSubstr(command));
}

TEST(Usage, version_is_one_line) {
  const Finished finished = run({"--version"});
  EXPECT_EQ(finished.status, 0);
  EXPECT_EQ(finished.out, fmt::format("lamplock {}\n", version()));
}

TEST(Usage, version_with_verbose_has_the_build) {
  const Finished finished = run({"--version", "--verbose"});
  EXPECT_EQ(finished.status, 0);
  EXPECT_EQ(finished.err, "");
  EXPECT_THAT(finished.out, testing::StartsWith(fmt::format("lamplock {}\n", version())));
  EXPECT_THAT(finished.out,
              HasSubstr(fmt::format("\ncompiler  {}, {}\n", compiler(), build_type())));
  EXPECT_THAT(finished.out, HasSubstr(fmt::format("\nprotocol  {}\n", wire::protocol_version)));
  EXPECT_THAT(finished.out, HasSubstr("\nboard     rp2040: "));
  for (const char* library :
       {"Boost", "CLI11", "fmt", "hidapi-hidraw", "libedit", "libgpiod", "libpng", "libusb-1.0",
        "libzip", "nanoflann", "nlohmann_json", "pugixml", "sqlite3", "stb", "tomlplusplus"})
    EXPECT_THAT(finished.out,
                testing::ContainsRegex(fmt::format("\nlibrary   {} [0-9.]+\n", library)));
}

TEST(Usage, version_as_json_has_the_build) {
  const Finished finished = run({"--json", "--version"});
  EXPECT_EQ(finished.status, 0);
  const auto document = nlohmann::json::parse(finished.out);
  EXPECT_EQ(document["version"], version());
  EXPECT_EQ(document["protocol"], wire::protocol_version);
  EXPECT_EQ(document["libraries"].size(), libraries().size());
  for (const auto& board : document["boards"])
    for (const auto& image : board["images"])
      EXPECT_NE(read(image.get<std::string>()), "") << image;
}

/// Invalid arguments, and a word that the error must have.
struct Wrong {
  std::vector<std::string> arguments;
  std::string names;
};
class WrongUsage : public testing::TestWithParam<Wrong> {};

TEST_P(WrongUsage, is_one_line_with_status_2) {
  const Finished wrong = run(GetParam().arguments);
  EXPECT_EQ(wrong.status, 2);
  EXPECT_EQ(wrong.out, "");
  EXPECT_THAT(wrong.err, testing::MatchesRegex("error: [^\n]+: [^\n]+; [^\n]*\n"));
  EXPECT_THAT(wrong.err, HasSubstr(GetParam().names));
}

INSTANTIATE_TEST_SUITE_P(
    all, WrongUsage,
    testing::Values(
        Wrong{{}, "command"}, Wrong{{"--verbose"}, "--version"},
        Wrong{{"--version", "bogus"}, "'bogus'"}, Wrong{{"--version", "--jsonn"}, "'--json'"},
        Wrong{{"-x"}, "unknown option '-x'; see lamplock --help"},
        Wrong{{"engrave", "a.stl", "--fired", "3"}, "--fired: needs --from"},
        Wrong{{"--json", "example", "a.stl"}, "--version"}, Wrong{{"carve"}, "carve"},
        Wrong{{"engrave"}, "INPUT"}, Wrong{{"engrave", "a.stl", "--colour", "red"}, "--colour"},
        Wrong{{"engrave", "a.stl", "--spacing", "wide"}, "wide"},
        Wrong{{"engrave", "a.stl", "--mode", "fast"}, "--mode"},
        Wrong{{"engrave", "a.stl", "--from", "-1"}, "--from"},
        Wrong{{"engrave", "a.xyz", "--drive-lag", "1,2,3,4,5"}, "--drive-lag"},
        Wrong{{"engrave", "--drive-lag", "1,2", "--drive-lag", "3,4,5", "a.xyz"}, "--drive-lag"},
        Wrong{{"engrave", "a.xyz", "--drive-lag", "5001"}, "--drive-lag"},
        Wrong{{"order", "a.xyz"}, "--output"}, Wrong{{"compare", "a"}, "SECOND"},
        Wrong{{"job"}, "--show"}, Wrong{{"bench", "--rows", "glass"}, "--rows"},
        Wrong{{"bench", "--points", "0"}, "--points"}, Wrong{{"bench", "--seed", "-3"}, "--seed"},
        Wrong{{"bench", "--chart", ""}, "--chart"},
        Wrong{{"engrave", "a.xyz", "--vcd", ""}, "--vcd"},
        Wrong{{"engrave", "a.xyz", "--report", ""}, "--report"},
        Wrong{{"settings", "get"}, "SETTING"}, Wrong{{"settings", "set"}, "CHANGE"}));

}  // namespace
}  // namespace lamplock::cli::test
