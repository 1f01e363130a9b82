// Rules for the help of every command, also of commands of commands: width, ranges, units,
// defaults, examples.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "host/cli/help.hpp"
#include "host/cli/program.hpp"
#include "host/cli/usage_error.hpp"
#include "tests/cli/program.hpp"

namespace lamplock::cli::test::help_rules {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

using Visit = std::function<void(const Command&, const std::string& path)>;

void visit_all(const Command& command, const std::string& path, const Visit& visit) {
  visit(command, path);
  for (const Command& inner : command.commands())
    visit_all(inner, path + " " + inner.name(), visit);
}

void for_all(const Visit& visit) {
  const auto program = make_program();
  visit_all(*program, "lamplock", visit);
}

bool takes_numbers(const Option& option) {
  return std::visit(
      [](auto* place) {
        using Value = std::remove_pointer_t<decltype(place)>;
        return !std::is_same_v<Value, bool> && !std::is_same_v<Value, std::optional<bool>> &&
               !std::is_same_v<Value, std::string> &&
               !std::is_same_v<Value, std::optional<std::string>> &&
               !std::is_same_v<Value, std::vector<std::string>>;
      },
      option.target());
}

std::size_t quotes_in(const std::string& line, char quote) {
  return static_cast<std::size_t>(std::count(line.begin(), line.end(), quote));
}

/// Lines that begin with two blanks after "Example:".
std::vector<std::string> example_lines(const std::string& help) {
  std::vector<std::string> found;
  bool in_examples = false;
  for (const std::string& line : lines(help)) {
    if (in_examples && line.starts_with("  ")) found.push_back(line);
    in_examples = line == "Example:" || (in_examples && line.starts_with("  "));
  }
  return found;
}

TEST(HelpRules, no_line_is_too_long_or_ends_in_a_blank) {
  for_all([](const Command& command, const std::string& path) {
    for (const std::size_t width : {40u, 47u, 60u, 80u, 100u})
      for (const HelpKind kind : {HelpKind::common, HelpKind::all})
        for (const std::string& line : lines(help_text(command, path, kind, width))) {
          // A word of a command cannot be divided.
          const bool is_word = line.find(' ', line.find_first_not_of(' ')) + 2 >= line.size() &&
                               line.ends_with('\\');
          EXPECT_TRUE(line.size() <= width || is_word) << path << " " << width << ": " << line;
          EXPECT_FALSE(line.ends_with(' ')) << path << ": " << line;
          EXPECT_FALSE(line.ends_with(" ;")) << path << ": " << line;
        }
  });
}

TEST(HelpRules, limited_numbers_show_their_range_once) {
  /// Coordinates, angles and directions, which may be any number.
  const std::set<std::string> any{"--turn", "--block-at", "--plot-beats", "--origin"};
  for_all([&](const Command& command, const std::string& path) {
    const std::string text =
        std::regex_replace(help_text(command, path, HelpKind::all, 100), std::regex("\\s+"), " ");
    EXPECT_THAT(text, Not(ContainsRegex("[0-9]e[-+]?[0-9]"))) << path;
    for (const Option& option : command.options()) {
      if (!takes_numbers(option)) continue;
      EXPECT_TRUE(!option.check().range.empty() || any.contains(option.name()))
          << path << " " << option.name() << " has no range";
      // Neither the name of the value nor the text repeats it.
      if (!option.check().range.empty()) {
        EXPECT_THAT(option.value_name(), Not(HasSubstr("|"))) << path << option.name();
        EXPECT_THAT(option.help(), Not(HasSubstr(option.check().range))) << path << option.name();
      }
    }
  });
}

TEST(HelpRules, units_and_defaults_have_one_form) {
  for_all([](const Command& command, const std::string& path) {
    for (const Option& option : command.options()) {
      EXPECT_THAT(option.value_name(), Not(ContainsRegex("[A-Z]/[A-Z]"))) << path << option.name();
      EXPECT_THAT(option.help(), Not(ContainsRegex("[Dd]efault:|\\(default")))
          << path << " " << option.name();
    }
  });
  const std::string jog = std::regex_replace(run({"jog", "--help"}).out, std::regex("\\s+"), " ");
  EXPECT_THAT(jog, HasSubstr("--step MM Step length at the start (0.001 to 100; default: 0.1)"));
}

/// Of the options that -h shows of a command that has more.
TEST(HelpRules, the_short_help_has_about_a_dozen_options) {
  for_all([](const Command& command, const std::string& path) {
    const std::string text = help_text(command, path, HelpKind::common, 80);
    if (text.find("Common options:") == std::string::npos) return;
    const auto all = lines(text);
    const auto shown = std::count_if(
        all.begin(), all.end(), [](const std::string& line) { return line.starts_with("  -"); });
    EXPECT_GE(shown, 8) << path;
    EXPECT_LE(shown, 20) << path;
  });
  const std::string sim = run({"sim", "-h"}).out;
  for (const char* option : {"--pty", "--tcp", "--lamp", "--board", "--seconds", "--machine"})
    EXPECT_THAT(sim, HasSubstr("\n  " + std::string(option) + " "));
}

TEST(HelpRules, commands_of_commands_name_the_help_of_the_inner_ones) {
  for_all([](const Command& command, const std::string& path) {
    if (command.commands().empty()) return;
    for (const HelpKind kind : {HelpKind::common, HelpKind::all})
      EXPECT_THAT(help_text(command, path, kind, 80), HasSubstr(path + " COMMAND -h"));
  });
}

/// The words of a shell command, without its comment.
std::vector<std::string> words_of(const std::string& line) {
  std::vector<std::string> words;
  std::string word;
  bool is_begun = false;
  char quote = 0;
  for (const char c : line + " ") {
    if (quote == 0 && !is_begun && c == '#') break;
    if (c == quote) {
      quote = 0;
    } else if (quote == 0 && (c == '"' || c == '\'')) {
      quote = c;
      is_begun = true;
    } else if (quote == 0 && c == ' ') {
      if (is_begun) words.push_back(std::exchange(word, {}));
      is_begun = false;
    } else {
      word += c;
      is_begun = true;
    }
  }
  return words;
}

/// An example of `settings` without its board, which is then a simulated one; nothing of examples
/// that name a file.
std::optional<std::vector<std::string>> on_simulated_board(std::vector<std::string> words) {
  if (words.size() < 2 || words[0] != "settings") return std::nullopt;
  if (words[1] == "backup" || words[1] == "restore") return std::nullopt;
  const auto board = std::find(words.begin(), words.end(), "--board");
  if (board != words.end()) words.erase(board, board + 2);
  return words;
}

/// Settings that do not exist, or are named twice, are seen by the command only, not by the parser.
TEST(HelpRules, examples_of_settings_run) {
  std::size_t count = 0;
  for_all([&](const Command& command, const std::string& path) {
    for (const std::string& line : example_lines(help_text(command, path, HelpKind::all, 200))) {
      std::vector<std::string> words = words_of(line);
      if (words.empty() || words[0] != "lamplock") continue;
      words.erase(words.begin());
      const auto simulated = on_simulated_board(words);
      if (!simulated) continue;
      EXPECT_EQ(run(*simulated).err, "") << path << ": " << line;
      ++count;
    }
  });
  EXPECT_GE(count, 5u);
}

/// As printed at any width: options, ranges, required arguments are right.
TEST(HelpRules, examples_are_commands_that_the_program_accepts) {
  const auto program = make_program();
  std::size_t count = 0;
  for_all([&](const Command& command, const std::string& path) {
    for (const std::size_t width : {40u, 80u}) {
      std::string text;
      for (const std::string& line :
           example_lines(help_text(command, path, HelpKind::all, width))) {
        EXPECT_EQ(quotes_in(line, '"') % 2, 0u) << path << ": " << line;
        EXPECT_EQ(quotes_in(line, '\'') % 2, 0u) << path << ": " << line;
        text += line;
        if (text.ends_with(" \\")) {
          text.pop_back();
          continue;
        }
        std::vector<std::string> words = words_of(std::exchange(text, {}));
        const auto begin = std::find(words.begin(), words.end(), "lamplock");
        if (begin == words.end()) continue;  // a comment
        words.erase(words.begin(), begin + 1);
        const auto error = usage_error(*program, words);
        EXPECT_FALSE(error) << path << ": " << line << ": " << error->what();
        ++count;
      }
      EXPECT_EQ(text, "") << path;
    }
  });
  EXPECT_GT(count, 60u);
}

TEST(HelpRules, errors_of_numbers_name_option_range_and_unit) {
  const auto err = [](std::vector<std::string> words) { return run(words).err; };
  EXPECT_THAT(err({"engrave", "x.xyz", "--dropouts", "200"}),
              HasSubstr("error: --dropouts: 200 is out of range; give 0 to 100 percent; see"));
  EXPECT_THAT(err({"sim", "--lamp", "0"}), HasSubstr(" Hz; see"));
  EXPECT_THAT(err({"sim", "--speed", "1e9"}), HasSubstr(" m/s; see"));
  EXPECT_THAT(err({"order", "x.xyz", "-o", "y.xyz", "--cone-up", "-1"}),
              HasSubstr("give at least 0 mm/mm"));
  EXPECT_THAT(err({"jog", "--feed", "0"}), HasSubstr("give 0.001 to 1000000 mm/min"));
}

/// A limit of the simulated lamp is the one of the option.
TEST(HelpRules, the_greatest_faults_of_a_lamp_are_accepted) {
  const Folder folder;
  const std::string list = folder.write("p.xyz", "0 0 0\n");
  for (const std::vector<std::string>& fault :
       std::vector<std::vector<std::string>>{{"--wander", "50"}, {"--dropouts", "10"}}) {
    std::vector<std::string> words{"engrave", list, "--dry"};
    words.insert(words.end(), fault.begin(), fault.end());
    EXPECT_THAT(run(words).err, Not(HasSubstr("error: " + fault[0])));
  }
}

/// With the materials that the program brings.
TEST(HelpRules, examples_name_settings_of_the_library) {
  const Folder folder;
  const std::string file = folder.write("p.ngc", "G1 X1 F#<_material_feed>\n");
  const std::regex choice("--material ([^ ]+)( --thickness ([^ ]+))?");
  std::set<std::vector<std::string>> choices;
  for_all([&](const Command& command, const std::string& path) {
    for (const std::string& line : example_lines(help_text(command, path, HelpKind::all, 200))) {
      std::smatch found;
      const bool is_program = path == "lamplock check" || path == "lamplock send";
      if (!is_program || !std::regex_search(line, found, choice)) continue;
      std::vector<std::string> words{"check", file, "--material", found[1]};
      if (found[3].matched) words.insert(words.end(), {"--thickness", found[3]});
      choices.insert(words);
    }
  });
  EXPECT_GE(choices.size(), 1u);
  for (const auto& words : choices) EXPECT_EQ(run(words).status, 0) << run(words).err;
}

TEST(HelpRules, a_missing_example_model_names_the_command_that_writes_it) {
  const Folder folder;
  const std::string job = folder.write("block.toml", "[[object]]\nfile = \"nautilus.stl\"\n");
  const std::string model = folder / "nautilus.stl";
  EXPECT_THAT(run({"engrave", job}).err, HasSubstr("lamplock example " + model));
  EXPECT_EQ(run({"example", model}).status, 0);
  EXPECT_THAT(run({"estimate", "--help"}).out, HasSubstr("llj"));
}

}  // namespace
}  // namespace lamplock::cli::test::help_rules
