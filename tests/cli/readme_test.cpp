// The commands of README.md run as printed, each block in a fresh folder.
//
// A fenced block without a label is a script for a shell, so that a new block is run without an
// entry here; a block that is no script has a label (```text). A script whose commands all begin
// with a word of `building` sets the project up or builds it, and is not run. The folder has a copy
// of `examples`. A command for a board that is connected is run with the option that the page gives
// for those without a board: `--board virtual` instead of `--board auto`, `lamplock flash --board
// chip`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "host/text.hpp"
#include "tests/cli/program.hpp"
#include "tests/docs/page.hpp"
#include "tests/paths.hpp"

namespace lamplock::cli::test::readme {
namespace {

namespace fs = std::filesystem;

/// First words of commands that set up or build the project.
constexpr std::array<std::string_view, 7> building{"toolchain/", "cmake", "cpack", "ctest",
                                                   "git",        "apt",   "sudo"};

/// A fenced block of the page.
struct Block {
  std::string name;  ///< letters and digits of the heading, and the number of the line
  std::string label, script;
};

std::string letters_of(const std::string& heading) {
  std::string letters;
  for (const char c : heading)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) letters += c;
  return letters;
}

/// True for a line that begins with such a command.
bool is_building(const std::string& line) {
  return std::any_of(building.begin(), building.end(),
                     [&line](std::string_view word) { return line.starts_with(word); });
}

/// True if every line of a script sets up or builds the project.
bool is_building_only(const std::string& script) {
  const std::vector<std::string> all = lines(script);
  return std::all_of(all.begin(), all.end(), is_building);
}

/// Blocks of the page, in its order.
std::vector<Block> blocks_of_page() {
  std::vector<Block> blocks;
  std::string heading;
  bool is_inside = false;
  std::size_t number = 0;
  for (const std::string& line : lines(lamplock::test::read_repository_file("README.md"))) {
    ++number;
    const std::string text(trimmed(line));  // a block of a list is indented
    if (text.starts_with("```")) {
      is_inside = !is_inside;
      if (is_inside)
        blocks.push_back({letters_of(heading) + "_" + std::to_string(number), text.substr(3), ""});
    } else if (is_inside) {
      blocks.back().script += text + '\n';
    } else if (line.starts_with("## ")) {
      heading = line;
    }
  }
  return blocks;
}

/// Those that a user of the built program runs.
std::vector<Block> blocks_to_run() {
  std::vector<Block> blocks = blocks_of_page();
  std::erase_if(blocks, [](const Block& block) {
    return !block.label.empty() || is_building_only(block.script);
  });
  return blocks;
}

constexpr std::string_view real_board = "--board auto", simulated_board = "--board virtual";
constexpr std::string_view flash = "lamplock flash --for pico",
                           flash_chip = "lamplock flash --for pico --board chip";

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

/// The same script without a board.
std::string on_simulated_boards(std::string script) {
  replace_all(script, real_board, simulated_board);
  replace_all(script, flash, flash_chip);
  return script;
}

/// Runs a script until its first command that fails; returns its output.
Finished run_script(const Folder& folder, const std::string& script) {
  folder.write("script", script);
  fs::copy(lamplock::test::in_repository("examples"), folder / "examples",
           fs::copy_options::recursive);
  const fs::path program(program_path());
  std::ostringstream shell;
  shell << "cd '" << folder.path().string() << "' && PATH='" << program.parent_path().string()
        << "':\"$PATH\" bash -eu -o pipefail script >out 2>err </dev/null";
  const int status = std::system(shell.str().c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(folder / "out"), read(folder / "err")};
}

/// The build with sanitizers has no flash image.
bool has_image() { return fs::exists(lamplock::test::in_build("lamplock-rp2040.uf2")); }

/// One test for all blocks: lists of tests are made when this file is compiled, not when the page
/// changes.
TEST(Readme, blocks_run_as_printed) {
  for (const Block& block : blocks_to_run()) {
    if (block.script.find(flash) != std::string::npos && !has_image()) continue;
    const Folder folder;
    const Finished finished = run_script(folder, on_simulated_boards(block.script));
    EXPECT_EQ(finished.status, 0) << block.name << '\n'
                                  << block.script << finished.out << finished.err;
    EXPECT_THAT(finished.err, testing::Not(testing::HasSubstr("error:"))) << block.name;
  }
}

TEST(Readme, gives_the_options_of_those_without_a_board) {
  const std::string page = lamplock::test::read_repository_file("README.md");
  for (const std::string_view option : {simulated_board, real_board, flash_chip})
    EXPECT_THAT(page, testing::HasSubstr("`" + std::string(option) + "`"));
}

/// After the image is written, every command of a first job is for the connected board.
TEST(Readme, commands_of_a_first_job_are_for_the_connected_board) {
  std::size_t commands = 0;
  for (const Block& block : blocks_to_run())
    if (block.name.starts_with("Fromboardtofirstjob"))
      for (const std::string& line : lines(block.script)) {
        EXPECT_TRUE(line.starts_with(flash) || line.find(real_board) != std::string::npos) << line;
        ++commands;
      }
  EXPECT_EQ(commands, 6u);
}

/// True if a line of a script is such a command.
bool has_line(const std::string& script, bool (*is_wanted)(const std::string&)) {
  const std::vector<std::string> all = lines(script);
  return std::any_of(all.begin(), all.end(), is_wanted);
}

TEST(Readme, a_block_that_builds_has_no_other_commands) {
  for (const Block& block : blocks_of_page())
    EXPECT_EQ(has_line(block.script, is_building), is_building_only(block.script)) << block.name;
}

TEST(Readme, a_block_with_a_label_has_no_commands) {
  const auto is_command = [](const std::string& line) { return line.starts_with("lamplock "); };
  std::size_t with_commands = 0;
  for (const Block& block : blocks_of_page()) {
    const bool has_commands = has_line(block.script, is_command);
    EXPECT_TRUE(block.label.empty() || !has_commands) << block.name;
    with_commands += has_commands ? 1 : 0;
  }
  EXPECT_EQ(with_commands, blocks_to_run().size());
  EXPECT_GE(with_commands, 1u);
}

TEST(Readme, a_script_ends_at_its_first_command_that_fails) {
  const Folder folder;
  EXPECT_EQ(run_script(folder, "lamplock points none.stl -o none.ply\ntrue\n").status, 2);
}

}  // namespace
}  // namespace lamplock::cli::test::readme
