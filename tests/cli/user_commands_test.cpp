// User commands: run at rest, once and in order, with their arguments; a failure ends the program.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "tests/cli/program.hpp"
#include "tests/cli/run_json.hpp"

namespace lamplock::cli::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A folder of commands, each a script that appends its arguments to `log`.
class UserCommandRuns : public testing::Test {
 protected:
  void command(const std::string& name, const std::string& rest = "") {
    const std::string file = folder_.write(
        name, "#!/bin/sh\necho " + name + " $1 $2 $(wc -c < /dev/stdin) >> " + log() + "\n" + rest);
    ASSERT_EQ(::chmod(file.c_str(), 0700), 0);
  }
  std::string log() const { return folder_ / "log"; }
  std::string program(const std::string& text) const { return folder_.write("p.ngc", text); }
  std::vector<std::string> send(const std::string& file) const {
    return {"send", file, "--board", "virtual", "--user-commands", folder_.path().string()};
  }
  Finished check(const std::string& file) const {
    return run({"check", file, "--user-commands", folder_.path().string()});
  }

  Folder folder_;
};

TEST_F(UserCommandRuns, RunInOrderWithTheirArguments) {
  command("M101", "echo shown; echo end >> " + log() + "\n");
  command("M150");
  const std::string file = program(
      "G21\nG1 X2 F6000\nM101 P5\n#1=2\no1 repeat [2]\nG1 X#1\nM150 Q[#1/4] P-1.5\n"
      "o1 endrepeat\nM101\nM2\n");
  EXPECT_EQ(check(file).status, 0);
  EXPECT_TRUE(folder_.files() == (std::vector<std::string>{"M101", "M150", "p.ngc"})) << "checked";
  const Finished sent = run(send(file));
  EXPECT_EQ(sent.status, 0) << sent.err;
  EXPECT_THAT(lines(read(log())),
              ElementsAre("M101 5.000000 -1.000000 0", "end", "M150 -1.500000 0.500000 0",
                          "M150 -1.500000 0.500000 0", "M101 -1.000000 -1.000000 0", "end"));
  EXPECT_THAT(sent.err, HasSubstr("shown"));
  EXPECT_THAT(sent.out, HasSubstr("9 of 9 lines"));
}

/// The board does not get the line of the command, but its messages.
TEST_F(UserCommandRuns, ShowTheMessagesOfTheirLine) {
  command("M101");
  const Finished sent =
      run(send(program("G21\n(MSG, before)\nM101 P5 (MSG, beside)\n(MSG, after)\nM2\n")));
  EXPECT_EQ(sent.status, 0) << sent.err;
  const auto before = sent.err.find("machine: before"), beside = sent.err.find("machine: beside"),
             shown = sent.err.find("user command: M101"), after = sent.err.find("machine: after");
  EXPECT_LT(before, beside);
  EXPECT_LT(beside, shown);
  EXPECT_LT(shown, after);
  EXPECT_NE(after, std::string::npos) << sent.err;
}

/// The pause that takes the place of the command is not named.
TEST_F(UserCommandRuns, AreNamedInErrors) {
  command("M101");
  for (const std::string begin : {"", "o1 if [1]\no1 endif\n"}) {
    const std::string file =
        program(begin + "G5.2 X1 Y1 F100\nX2 Y2\n  M101 P5\nX3 Y1\nG5.3\nM2\n");
    const std::string what = fmt::format("p.ngc:{}:3: error:20 'M101' must not be within a NURBS",
                                         begin.empty() ? 3 : 5);
    EXPECT_THAT(check(file).out, HasSubstr(what));
    EXPECT_THAT(run(send(file)).err, HasSubstr(what));
  }
  for (const std::string line : {"M101 P1 P2", "M101 P9999999999999"}) {
    const std::string file = program("G21\n" + line + "\nM2\n");
    EXPECT_THAT(check(file).err, HasSubstr("p.ngc:2:"));
    EXPECT_THAT(run(send(file)).err, HasSubstr("p.ngc:2:"));
  }
}

/// The board has executed the lines before and reports that it is idle; none after them has begun.
TEST_F(UserCommandRuns, RunAtRest) {
  const std::string events = folder_ / "events";
  command("M101", "cp " + events + " " + (folder_ / "seen") + "\n");
  const std::string file = program("M4 S100\nG1 X9 F6000\nG1 Y9\nM101\nG1 X0\nY0\n");
  std::vector<std::string> arguments = send(file);
  arguments.insert(arguments.end(), {"--events", events});
  ASSERT_EQ(run(arguments).status, 0);
  const std::vector<std::string> before = lines(read(folder_ / "seen"));
  ASSERT_EQ(before.size(), 3u);
  const Json last = Json::parse(before[2], nullptr, false);
  EXPECT_EQ(last["line"], 3);
  EXPECT_EQ(last["state"], "Idle");
  EXPECT_NEAR(last["position"][1], 9, 0.01);
  EXPECT_EQ(lines(read(events)).size(), 7u);
}

TEST_F(UserCommandRuns, AFailureEndsTheProgram) {
  command("M101", "exit 3\n");
  command("M102", "kill -9 $$\n");
  folder_.write("M103", "no script");
  ASSERT_EQ(::chmod((folder_ / "M103").c_str(), 0700), 0);
  for (const auto& [name, what] :
       {std::pair{"M101", "M101: ended with status 3, so the program ends"},
        std::pair{"M102", "M102: was ended by signal 9, so the program ends"},
        std::pair{"M103", "M103: cannot be run (Exec format error); begin the script"}}) {
    const std::string file = program("G1 X2 F6000\n" + std::string(name) + "\nG1 X9\n");
    std::vector<std::string> arguments = send(file);
    arguments.emplace_back("--json");
    const Finished sent = run(arguments);
    EXPECT_EQ(sent.status, 1) << name;
    EXPECT_THAT(sent.err, HasSubstr(what));
    EXPECT_THAT(sent.err, HasSubstr("error: " + file + ":2: " + (folder_ / name) + ": "));
    EXPECT_NEAR(Json::parse(sent.out)["position"][0], 2, 0.01);
  }
}

/// Of the call, and of the line in the file that it calls.
TEST_F(UserCommandRuns, AFailureNamesTheLine) {
  command("M101", "exit 3\n");
  folder_.write("tip.ngc", "o<tip> sub\nG0 X1\nM101\no<tip> endsub\n");
  const std::string file = program("G21\no<tip> call\nM2\n");
  const Finished sent = run(send(file));
  EXPECT_EQ(sent.status, 1);
  EXPECT_THAT(sent.err, HasSubstr("error: " + file + ":2 (in " + (folder_ / "tip.ngc") + ":3): "));
}

TEST_F(UserCommandRuns, CtrlCEndsTheCommandAndTheProgram) {
  command("M101", "sleep 60 & wait\necho late >> " + log() + "\n");
  Running sending(send(program("G1 X2 F6000\nM101\nG1 X9\n")));
  ASSERT_TRUE(sending.wait_for("user command: M101"));
  std::this_thread::sleep_for(std::chrono::milliseconds{300});
  const auto begin = std::chrono::steady_clock::now();
  sending.interrupt();
  const Finished ended = sending.finish();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds{10});
  EXPECT_NE(ended.status, 0);
  EXPECT_THAT(read(log()), testing::Not(HasSubstr("late")));
}

TEST_F(UserCommandRuns, NothingIsSentThatCannotBeRun) {
  const auto both = [&](const std::string& text, const std::string& what) {
    const std::string file = program(text);
    for (const Finished& ended : {check(file), run(send(file))}) {
      EXPECT_EQ(ended.status, 2) << text;
      EXPECT_THAT(ended.out + ended.err, HasSubstr(what)) << text;
    }
  };
  both("G21\nM101\n", "p.ngc:2: 'M101': there is no file");
  folder_.write("M101", "#!/bin/sh\n");
  both("G21\nM101\n", "M101 is not executable; permit it: chmod +x");
  command("M101");
  both("M101 X5\n", "p.ngc:1:6: 'X5' is in the line of a user command");
  both("o1 if [1]\nM102\no1 endif\n", "p.ngc:2: 'M102': there is no file");
  both("G21\nG41.1 D1\nG0 X5\nM101\nG40\n", "error:90");
  EXPECT_FALSE(std::filesystem::exists(log()));
  const std::string file = program("G21\nM101 P1\n");
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"check", file},
        std::vector<std::string>{"send", file, "--board", "virtual"}}) {
    Finished refused = run(command);
    EXPECT_EQ(refused.status, 2);
    EXPECT_THAT(refused.out + refused.err,
                HasSubstr(":2:1: error:20 'M101' is a user command, and none are permitted"));
    EXPECT_THAT(refused.out + refused.err, HasSubstr("run it with --user-commands FOLDER"));
    std::vector<std::string> none = command;
    none.insert(none.end(), {"--user-commands", folder_ / "none"});
    EXPECT_THAT(run(none).err,
                HasSubstr("--user-commands: " + (folder_ / "none") + ": no such folder"));
  }
}

}  // namespace
}  // namespace lamplock::cli::test
