// Manual pages and completions contain exactly the options and commands of the command line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <set>
#include <sstream>

#include "host/bench/command_bench.hpp"
#include "host/chip_tool/command_chip.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/program.hpp"
#include "host/file.hpp"
#include "host/manual/commands.hpp"
#include "host/manual/completion.hpp"
#include "host/manual/man_page.hpp"
#include "host/serve_tool/commands.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::manual {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// The command line of the program, including the commands that are programs of their own.
struct RealProgram {
  RealProgram() {
    serve_tool::add_serve(*app);
    serve_tool::add_watch(*app);
    chip_tool::add_chip(*app);
    bench::add_bench(*app);
    cli::add_help(*app);
  }
  std::unique_ptr<cli::Command> app = cli::make_own_commands();
};

/// A small command line with awkward texts.
struct SmallProgram {
  SmallProgram() {
    cli::Command& cut = app.add_command("cut", "Cut. It's \\sharp");
    cut.add_option("--depth", &depth, "How deep").value_name("MM").show_default();
    cut.add_option("--mode", &mode, "How").value_name("fast|slow|PORT");
    cut.add_option("-o,--output", &file, "Where to").value_name("FILE").environment("CUT_TO");
    cut.add_option("--dry", &dry, "Not really");
    cut.add_option("--secret", &file, "Hidden").group("");
    cut.add_option("INPUT", &file, "What").required();
    cut.footer("One\ntwo.\n\nThree.\nExample:\n  .cut it\n  'cut\n\nThe end.");
    cli::Command& deep = app.add_command("deep", "Commands of its own");
    deep.add_command("inner", "One of them").add_option("--turned", &dry, "Turned");
  }
  double depth = 2.5;
  std::string mode, file;
  bool dry = false;
  cli::Command app{"lamplock", "Small."};
};

std::string page_of(const cli::Command& app, const std::string& file) {
  for (const Page& page : man_pages(app, {"1.2.3", "2026-01-02"}))
    if (page.file == file) return page.text;
  return "";
}

TEST(ManPage, HasNameSynopsisOptionsAndExamples) {
  const SmallProgram program;
  const std::string page = page_of(program.app, "lamplock-cut.1");
  EXPECT_THAT(page, HasSubstr(".TH LAMPLOCK\\-CUT 1 \"2026-01-02\" \"lamplock 1.2.3\""));
  EXPECT_THAT(page, HasSubstr("lamplock\\-cut \\- Cut. It's \\esharp\n"));
  EXPECT_THAT(page, HasSubstr("\\fBlamplock cut\\fR [\\fIOPTIONS\\fR] \\fIINPUT\\fR\n"));
  EXPECT_THAT(page, HasSubstr(".TP\n\\fB\\-\\-depth\\fR \\fIMM\\fR\nHow deep. Default: 2.5.\n"));
  EXPECT_THAT(page, HasSubstr("\\fB\\-o\\fR, \\fB\\-\\-output\\fR \\fIFILE\\fR\nWhere to. Without "
                              "it, the environment variable CUT_TO gives the value.\n"));
  EXPECT_THAT(page, HasSubstr("\\fB\\-\\-dry\\fR\nNot really.\n"));
  EXPECT_THAT(page, HasSubstr(".SH NOTES\nOne two.\n.PP\nThree.\n.SH EXAMPLES\n"));
  EXPECT_THAT(page, HasSubstr(".nf\n\\&.cut it\n\\&'cut\n.fi\n.RE\n.PP\nThe end.\n"));
  EXPECT_THAT(page, Not(HasSubstr("secret")));
}

TEST(ManPage, InnerCommandsAreOnThePageOfTheirCommand) {
  const SmallProgram program;
  const std::string page = page_of(program.app, "lamplock-deep.1");
  EXPECT_THAT(page, HasSubstr(".SH LAMPLOCK DEEP INNER\nOne of them.\n"));
  EXPECT_THAT(page, HasSubstr("\\fB\\-\\-turned\\fR\nTurned.\n"));
}

TEST(ManPage, EveryCommandHasAPage) {
  const SmallProgram program;
  std::vector<std::string> files;
  for (const Page& page : man_pages(program.app, {})) files.push_back(page.file);
  EXPECT_THAT(files, ElementsAre("lamplock.1", "lamplock-cut.1", "lamplock-deep.1"));
}

/// Every option of every command is on its page; no line of a page is too long for a diff or would
/// be taken for a request by man.
TEST(ManPage, OfTheProgramIsComplete) {
  const RealProgram program;
  for (const cli::Command& command : program.app->commands()) {
    const std::string page = page_of(*program.app, "lamplock-" + command.name() + ".1");
    ASSERT_FALSE(page.empty()) << command.name();
    std::vector<const cli::Command*> described{&command};
    for (const cli::Command& inner : command.commands()) described.push_back(&inner);
    for (const cli::Command* one : described)
      for (const cli::Option* option : options_of(*one))
        for (const std::string& name : option->typed_names()) {
          std::string typed;
          for (const char c : name) typed += c == '-' ? std::string("\\-") : std::string(1, c);
          EXPECT_THAT(page, HasSubstr("\\fB" + typed + "\\fR")) << command.name();
        }
    const std::set<std::string> requests{".TH", ".SH", ".SS", ".TP", ".PP",
                                         ".RS", ".RE", ".nf", ".fi"};
    std::istringstream lines(page);
    for (std::string line; std::getline(lines, line);)
      if (line.starts_with('.') || line.starts_with('\'')) {
        EXPECT_TRUE(requests.contains(line.substr(0, 3))) << line;
      }
  }
}

TEST(Commands, ArgumentsAreWordsFilesAndPorts) {
  const SmallProgram program;
  const cli::Command& cut = program.app.commands().front();
  EXPECT_THAT(words_of(cut.option("--mode")), ElementsAre("fast", "slow"));
  EXPECT_TRUE(takes_port(cut.option("--mode")));
  EXPECT_THAT(words_of(cut.option("--depth")), IsEmpty());
  EXPECT_TRUE(takes_file(cut.option("--output")));
  EXPECT_FALSE(takes_file(cut.option("--mode")));
  EXPECT_EQ(argument_of(cut.option("--dry")), "");
}

/// A bash with the completion of an application.
class Shell {
 public:
  explicit Shell(const cli::Command& app)
      : script_(folder_.write("completion", bash_completion(app)).string()) {
    std::filesystem::create_directory(folder_.file("empty"));
  }

  /// Completions offered in an empty folder for the given words, one per line.
  std::string offers(const std::string& words) const {
    const std::string command = "bash -c 'cd " + folder_.file("empty").string() + "; . " + script_ +
                                "; COMP_WORDS=(" + words +
                                "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _lamplock; " +
                                "printf \"%s\\n\" \"${COMPREPLY[@]}\"' 2>&1";
    std::FILE* pipe = ::popen(command.c_str(), "r");
    if (pipe == nullptr) return "no bash";
    std::string text;
    std::array<char, 4096> piece{};
    while (const std::size_t n = std::fread(piece.data(), 1, piece.size(), pipe))
      text.append(piece.data(), n);
    ::pclose(pipe);
    return text;
  }
  const test::TemporaryFolder& folder() const { return folder_; }

 private:
  test::TemporaryFolder folder_;
  std::string script_;
};

TEST(Completion, BashOffersMatchingWords) {
  const SmallProgram program;
  const Shell shell(program.app);
  EXPECT_EQ(shell.offers("lamplock cu"), "cut\n");
  EXPECT_EQ(shell.offers("lamplock cut --d"), "--depth\n--dry\n");
  EXPECT_EQ(shell.offers("lamplock cut --mode s"), "slow\n");
  EXPECT_EQ(shell.offers("lamplock cut --mode = s"), "slow\n") << "as bash splits --mode=s";
  EXPECT_THAT(shell.offers("lamplock cut --mode ="), HasSubstr("slow\n"));
  EXPECT_EQ(shell.offers("lamplock cut --depth 3"), "\n") << "numbers are not completed";
  EXPECT_EQ(shell.offers("lamplock cut --depth 3 --se"), "\n");
  EXPECT_EQ(shell.offers("lamplock deep in"), "inner\n");
  EXPECT_EQ(shell.offers("lamplock deep inner --t"), "--turned\n");
  const test::TemporaryFolder& folder = shell.folder();
  folder.write("shape.stl", "");
  EXPECT_EQ(shell.offers("lamplock cut " + folder.file("sh").string()),
            folder.file("shape.stl").string() + "\n");
  EXPECT_EQ(shell.offers("lamplock cut -o " + folder.file("sh").string()),
            folder.file("shape.stl").string() + "\n");
  EXPECT_EQ(shell.offers("lamplock deep inner " + folder.file("sh").string()), "\n")
      << "this command takes no file";
}

TEST(Completion, BashKnowsEveryCommandOfTheProgram) {
  const RealProgram program;
  const Shell shell(*program.app);
  for (const cli::Command& command : program.app->commands()) {
    EXPECT_THAT("\n" + shell.offers("lamplock " + command.name()),
                HasSubstr("\n" + command.name() + "\n"));
  }
  EXPECT_THAT(shell.offers("lamplock operate ze"), HasSubstr("zero"));
  EXPECT_THAT(shell.offers("lamplock engrave --mod"), HasSubstr("--mode"));
  EXPECT_EQ(shell.offers("lamplock settings get lamp_f"), "lamp_frequency\n");
  EXPECT_EQ(shell.offers("lamplock settings get travel_x lamp_f"), "lamp_frequency\n");
  EXPECT_EQ(shell.offers("lamplock settings set lamp_f"), "lamp_frequency=\n");
  EXPECT_EQ(shell.offers("lamplock settings set lamp_frequency ="), "\n") << "a value is next";
  EXPECT_EQ(shell.offers("lamplock help engr"), "engrave\n");
  EXPECT_THAT(fish_completion(*program.app), HasSubstr("-f -a 'step_pulse "));
  EXPECT_THAT(bash_completion(*program.app), Not(HasSubstr(":{")))
      << "a set of values was not split";
}

TEST(Completion, FishQuotesSpecialCharacters) {
  const SmallProgram program;
  const std::string script = fish_completion(program.app);
  EXPECT_THAT(script, HasSubstr("-a cut -d 'Cut. It\\'s \\\\sharp'\n"));
  EXPECT_THAT(script, HasSubstr("'__fish_seen_subcommand_from cut' -l mode -x -a 'fast slow (ls "));
  EXPECT_THAT(script, HasSubstr("-s o -l output -r -d 'Where to'\n"));
  EXPECT_THAT(script, HasSubstr("'__fish_seen_subcommand_from deep; and "
                                "__fish_seen_subcommand_from inner' -l turned"));
  EXPECT_THAT(script, Not(HasSubstr("secret")));
}

}  // namespace
}  // namespace lamplock::manual
