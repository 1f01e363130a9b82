// Empty values of options, as a script gives them whose variable is unset, are refused.
#include <gmock/gmock.h>

#include <cstdlib>

#include "host/cli/command_line.hpp"
#include "host/cli/parser.hpp"
#include "host/cli/program.hpp"
#include "host/serve_tool/commands.hpp"
#include "tests/cli/program.hpp"

namespace lamplock::cli::test::empty_values {
namespace {

using testing::HasSubstr;

bool is_text(const Option& option) {
  return std::holds_alternative<std::string*>(option.target()) ||
         std::holds_alternative<std::optional<std::string>*>(option.target()) ||
         std::holds_alternative<std::vector<std::string>*>(option.target());
}

std::unique_ptr<Command> make_commands() {
  auto program = make_own_commands();
  serve_tool::add_serve(*program);
  serve_tool::add_watch(*program);
  return program;
}

/// The message of the refusal; empty if the arguments are accepted. All use one program, as making
/// it takes longer than a refusal.
std::string refusal_of(const std::vector<std::string>& arguments) {
  static const std::unique_ptr<Command> program = make_commands();
  try {
    run(*program, arguments);
  } catch (const Error& error) {
    EXPECT_EQ(error.exit(), Exit::bad_input);
    return error.what();
  }
  return "";
}

/// Tries every text option of a command and of the commands in it. Returns their number.
std::size_t check_options(const Command& command, const std::vector<std::string>& path) {
  std::size_t count = 0;
  const auto refused = [&](std::vector<std::string> last, const Option& option) {
    std::vector<std::string> arguments = path;
    arguments.insert(arguments.end(), last.begin(), last.end());
    EXPECT_THAT(refusal_of(arguments),
                testing::MatchesRegex("error: " + option.name() + ": has no (name|value); .*"))
        << testing::PrintToString(arguments);
    ++count;
  };
  for (const Option& option : command.options()) {
    if (!is_text(option)) continue;
    // Positionals before this one have a value in no test: the first one is tried.
    if (option.is_positional() && &option == &command.options().front()) refused({""}, option);
    if (option.is_positional()) continue;
    refused({option.name() + "="}, option);
    refused({option.name() + "=", "a.xyz"}, option);
    if (option.bare().empty()) refused({option.name(), ""}, option);
  }
  for (const Command& inner : command.commands()) {
    std::vector<std::string> longer = path;
    longer.push_back(inner.name());
    count += check_options(inner, longer);
  }
  return count;
}

TEST(EmptyValue, OfEveryTextOptionIsRefused) {
  constexpr std::size_t min_options = 200;
  EXPECT_GT(check_options(*make_commands(), {}), min_options);
}

/// Every flag of a command and of its inner commands with a value. Returns how many were tried.
std::size_t check_flags(const Command& command, const std::vector<std::string>& path) {
  std::size_t count = 0;
  for (const Option& option : command.options()) {
    if (!option.is_flag() || !option.name().starts_with("--")) continue;
    std::vector<std::string> arguments = path;
    arguments.push_back(option.name() + "=no");
    EXPECT_THAT(refusal_of(arguments),
                HasSubstr("error: " + option.name() + ": takes no value; leave out '=no'"))
        << testing::PrintToString(arguments);
    ++count;
  }
  for (const Command& inner : command.commands()) {
    std::vector<std::string> longer = path;
    longer.push_back(inner.name());
    count += check_flags(inner, longer);
  }
  return count;
}

TEST(EmptyValue, AFlagTakesNone) {
  constexpr std::size_t min_flags = 50;
  EXPECT_GT(check_flags(*make_commands(), {}), min_flags);
  EXPECT_THAT(refusal_of({"--version=3"}), HasSubstr("--version: takes no value"));
}

TEST(EmptyValue, OfAnEnvironmentVariableIsRefused) {
  const Folder folder;
  const std::string points = folder.write("a.xyz", "0 0 0\n1 0 0\n2 0 0\n");
  ::setenv("LAMPLOCK_LINES", "", 1);
  const Finished refused = cli::test::run({"engrave", points});
  const std::string given = refusal_of({"lines", "--lines", folder / "none.toml"});
  ::unsetenv("LAMPLOCK_LINES");
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("error: LAMPLOCK_LINES: has no name; unset this"));
  EXPECT_THAT(given, HasSubstr("none.toml"));
  EXPECT_EQ(cli::test::run({"engrave", points}).status, 0);
}

}  // namespace
}  // namespace lamplock::cli::test::empty_values
