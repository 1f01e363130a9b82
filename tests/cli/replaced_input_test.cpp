// No command replaces a file that it reads, or writes two outputs into one file, under whichever
// name the files are given.
#include <gmock/gmock.h>

#include <filesystem>
#include <string>
#include <vector>

#include "host/cli/file_options.hpp"
#include "host/cli/program.hpp"
#include "host/error.hpp"
#include "host/serve_tool/commands.hpp"
#include "tests/cli/inputs.hpp"
#include "tests/cli/program.hpp"

namespace lamplock::cli::test::replaced {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A command and those inside it.
std::vector<Command*> all_commands(Command& command) {
  std::vector<Command*> all{&command};
  for (Command& inner : command.commands())
    for (Command* one : all_commands(inner)) all.push_back(one);
  return all;
}

std::vector<Option*> options_of(Command& command, FileUse use) {
  std::vector<Option*> found;
  for (Option& option : command.options())
    if (option.file_use() == use) found.push_back(&option);
  return found;
}

void set(Option& option, const std::string& file) {
  if (auto* const* text = std::get_if<std::string*>(&option.target())) **text = file;
  if (auto* const* text = std::get_if<std::optional<std::string>*>(&option.target())) **text = file;
}

std::string refusal(const Command& command) {
  try {
    check_files(command);
  } catch (const Error& error) {
    EXPECT_EQ(error.exit(), Exit::bad_input);
    return error.what();
  }
  return "";
}

class Replaced : public testing::Test {
 protected:
  Replaced() {
    file_ = folder_.write("input.file", "text\n");
    fs::create_directory(folder_ / "inner");
    fs::create_symlink(file_, folder_ / "link");
    fs::create_symlink(folder_.path(), folder_ / "folder");
    fs::create_hard_link(file_, folder_ / "hard");
  }
  /// Names of the input.
  std::vector<std::string> names() const {
    return {file_,
            folder_ / "./input.file",
            folder_ / "inner/../input.file",
            folder_ / "link",
            folder_ / "folder/input.file",
            folder_ / "hard"};
  }
  const Folder folder_;
  std::string file_;
};

TEST_F(Replaced, EveryFileOfEveryCommandIsKnownAsInputOrOutput) {
  const auto program = make_own_commands();
  serve_tool::add_serve(*program);
  int files = 0;
  for (Command* command : all_commands(*program))
    for (const Option& option : command->options()) {
      const std::string& value = option.value_name();
      if (!value.starts_with("FILE") && value != "DIR" && value != "LINK") continue;
      ++files;
      EXPECT_NE(option.file_use(), FileUse::none) << command->name() << " " << option.name();
    }
  EXPECT_GT(files, 60);
}

TEST_F(Replaced, EveryOutputOfEveryCommandSparesEveryInput) {
  const auto program = make_own_commands();
  serve_tool::add_serve(*program);
  int pairs = 0;
  for (Command* command : all_commands(*program))
    for (Option* output : options_of(*command, FileUse::write))
      for (Option* input : options_of(*command, FileUse::read)) {
        ++pairs;
        set(*input, file_);
        for (const std::string& name : names()) {
          set(*output, name);
          EXPECT_THAT(refusal(*command), HasSubstr("is an input of this command"))
              << command->name() << " " << input->name() << " " << output->name() << " " << name;
        }
        set(*output, folder_ / "other");
        EXPECT_EQ(refusal(*command), "") << command->name() << " " << output->name();
        set(*output, "");
        set(*input, "");
      }
  EXPECT_GT(pairs, 60);
}

TEST_F(Replaced, TwoOutputsAreTwoFiles) {
  const auto program = make_own_commands();
  serve_tool::add_serve(*program);
  for (Command* command : all_commands(*program)) {
    const std::vector<Option*> outputs = options_of(*command, FileUse::write);
    for (std::size_t i = 0; i < outputs.size(); ++i)
      for (std::size_t k = 0; k < i; ++k) {
        set(*outputs[i], folder_ / "new");
        set(*outputs[k], folder_ / "inner/../new");
        EXPECT_THAT(refusal(*command), HasSubstr("is to be written by"));
        set(*outputs[i], "");
        set(*outputs[k], "");
      }
  }
}

/// The program itself, also for files that a description names.
TEST_F(Replaced, TheInputIsAsBefore) {
  const std::string list = folder_.write("p.xyz", xyz(walk(20, 1)));
  const std::string ball = folder_.write("ball.stl", octahedron_stl());
  const std::string picture = folder_.write("disc.bmp", disc_bmp(12));
  const std::string svg = folder_.write("p.svg", "G21 G91\nG1 X1 F6000\nM2\n");
  const std::string profile = folder_.write("m.toml", "lamp_frequency = 50\n");
  const std::string job = folder_.write(
      "job.toml", "[machine]\nprofile = \"m.toml\"\n[[object]]\nfile = \"ball.stl\"\n");
  fs::create_symlink("p.xyz", folder_ / "to-list.xyz");
  const std::vector<std::vector<std::string>> commands{
      {"order", list, "-o", list},
      {"order", list, "-o", folder_ / "to-list.xyz"},
      {"order", folder_ / "to-list.xyz", "-o", folder_ / "inner/../p.xyz"},
      {"points", list, "-o", list},
      {"points", list, "-o", folder_ / "o.xyz", "--machine", profile, "--save", profile},
      {"points", job, "-o", folder_ / "o.xyz", "--save", profile},
      {"job", job, "-o", folder_ / "o.llj", "--save", profile},
      {"estimate", job, "--page", ball},
      {"engrave", job, "--shots", ball},
      {"engrave", list, "--statistics", list},
      {"raster", picture, "--feed", "900", "--gcode", picture},
      {"check", svg, "--picture", svg},
      {"diagnose", svg, "--picture", svg},
      {"settings", "backup", profile, "--machine", profile},
      {"sim", "--machine", profile, "--shots", profile, "--seconds", "0.01"},
      {"sim", "--pty", folder_ / "to-list.xyz", "--seconds", "0.01"}};
  for (const auto& words : commands) {
    const Finished refused = run(words);
    EXPECT_THAT(refused.status, testing::AnyOf(2, 3)) << words[0] << refused.err;
    EXPECT_THAT(refused.err, testing::MatchesRegex("error: [^\n]+; [^\n]+\n")) << words[0];
    EXPECT_EQ(refused.out, "") << words[0];
  }
  EXPECT_EQ(read(list), xyz(walk(20, 1)));
  EXPECT_EQ(read(ball), octahedron_stl());
  EXPECT_EQ(read(picture), disc_bmp(12));
  EXPECT_EQ(read(profile), "lamp_frequency = 50\n");
  EXPECT_TRUE(fs::is_symlink(folder_ / "to-list.xyz"));
  EXPECT_EQ(run({"order", list, "-o", folder_ / "o.xyz"}).status, 0);
}

}  // namespace
}  // namespace lamplock::cli::test::replaced
