// The help of every command: complete, within the width of the terminal, short with -h.
#include "host/cli/help.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <regex>
#include <string>

#include "host/cli/program.hpp"
#include "tests/cli/program.hpp"

namespace lamplock::cli::test {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Every line fits, unless it is one word; words are indented by at most this.
void expect_within(const std::string& text, std::size_t width) {
  for (const std::string& line : lines(text)) {
    const auto begin = line.find_first_not_of(' ');
    const bool is_word = begin != std::string::npos && line.find(' ', begin) == std::string::npos;
    EXPECT_TRUE(line.size() <= width || is_word) << width << ": " << line;
  }
}

TEST(Help, FitsIntoTheTerminal) {
  const auto program = make_program();
  for (const std::size_t width : {40u, 60u, 80u, 120u}) {
    expect_within(help_text(*program, "lamplock", HelpKind::all, width), width);
    for (const Command& command : program->commands())
      for (const HelpKind kind : {HelpKind::common, HelpKind::all})
        expect_within(help_text(command, "lamplock " + command.name(), kind, width), width);
  }
}

TEST(Help, HasEveryOptionInItsGroup) {
  const auto program = make_program();
  for (const Command& command : program->commands()) {
    const std::string text = help_text(command, "lamplock", HelpKind::all, 80);
    for (const Option& option : command.options()) {
      if (option.group().empty()) continue;
      EXPECT_THAT(text, HasSubstr("\n  " + (option.is_positional() ? option.names()
                                                                   : option.typed_names().front())))
          << command.name();
      if (!option.is_positional()) {
        EXPECT_THAT(text, HasSubstr("\n" + option.group() + ":\n"));
      }
    }
  }
}

TEST(Help, IsShortWithTheCommonOptions) {
  const auto program = make_program();
  for (const Command& command : program->commands()) {
    const std::string text = help_text(command, "lamplock", HelpKind::common, 80);
    const auto all = lines(text);
    const auto options = std::count_if(
        all.begin(), all.end(), [](const std::string& line) { return line.starts_with("  -"); });
    EXPECT_LE(options, 20) << command.name();
  }
  const Finished engrave = run({"engrave", "-h"});
  EXPECT_EQ(engrave.status, 0);
  EXPECT_THAT(engrave.out, HasSubstr("\n  --spacing MM"));
  EXPECT_THAT(engrave.out, Not(HasSubstr("--light-depth")));
  EXPECT_THAT(engrave.out, HasSubstr("lamplock engrave --help lists the other "));
  EXPECT_THAT(engrave.out, HasSubstr("Example:\n  lamplock engrave"));
}

TEST(Help, IsShownByTheCommandHelp) {
  for (const char* command : {"engrave", "settings", "chip"})
    EXPECT_EQ(run({"help", command}).out, run({command, "--help"}).out);
  EXPECT_EQ(run({"help", "settings", "get"}).out, run({"settings", "get", "--help"}).out);
  EXPECT_EQ(run({"help"}).out, run({"--help"}).out);
  EXPECT_THAT(run({"help", "engrvae"}).err, HasSubstr("did you mean 'engrave'?"));
}

TEST(Help, OfACommandThatDoesNotExistIsAnError) {
  const std::vector<std::vector<std::string>> commands{{"nonsense", "--help"},
                                                       {"nonsense", "-h"},
                                                       {"settings", "nonsense", "-h"},
                                                       {"help", "nonsense"}};
  for (const auto& words : commands) {
    const Finished result = run(words);
    EXPECT_EQ(result.status, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_THAT(result.err, HasSubstr("unknown command 'nonsense'"));
  }
}

TEST(Help, ShowsRangesAndDefaultsInOneForm) {
  // Wrapped lines are joined.
  const std::string text =
      std::regex_replace(run({"engrave", "--help"}).out, std::regex("\\s+"), " ");
  EXPECT_THAT(text, HasSubstr("(1 to 140; default: 100)"));
  EXPECT_THAT(text, Not(HasSubstr("0..1")));
}

}  // namespace
}  // namespace lamplock::cli::test
