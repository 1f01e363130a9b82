// A board that is locked, held or stopped: every command gives the same cause and a remedy that
// works as it is written.
#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "host/link/not_ready.hpp"
#include "tests/cli/inputs.hpp"
#include "tests/cli/program.hpp"

namespace lamplock::cli::test::blocked_board {
namespace {

using Arguments = std::vector<std::string>;
using testing::HasSubstr;
using testing::Not;

class BlockedBoard : public testing::Test {
 protected:
  BlockedBoard()
      : profile_(folder_.write("m.toml", "homing = 1\n")),
        list_(folder_.write("p.xyz", xyz(walk(10, 4, 0.05)))),
        program_(folder_.write("p.ngc", "G21 G91\nG1 X1 F6000\n")),
        port_(folder_ / "port"),
        sim_({"sim", "--pty", port_, "--lamp", "200", "--machine", profile_}) {}

  /// Commands that move the board, with their errors.
  std::vector<Arguments> commands() const {
    return {{"engrave", list_, "--lamp", "200", "--machine", profile_, "--board", port_, "--yes"},
            {"send", program_, "--board", port_, "--yes"},
            {"operate", "init", "--board", port_}};
  }
  void expect_all(const std::string& what, const std::string& remedy) const {
    for (const Arguments& words : commands()) {
      const Finished refused = run(words);
      EXPECT_EQ(refused.status, 2) << words[0];
      EXPECT_THAT(refused.err, HasSubstr("error: machine: " + what)) << words[0];
      EXPECT_THAT(refused.err, HasSubstr(remedy)) << words[0];
      // A job on a held board asks its user first, who has no terminal here.
      EXPECT_THAT(refused.err, testing::MatchesRegex("(held by a hold [^\n]+\n)?error: [^\n]+\n"));
    }
  }
  Finished in_console(const std::string& line) const {
    return run({"console", "--board", port_}, line + "\n");
  }

  Folder folder_;
  std::string profile_, list_, program_, port_;
  Running sim_;
};

TEST_F(BlockedBoard, IsDescribedAlikeByAllCommands) {
  ASSERT_TRUE(sim_.wait_for("Ctrl-C"));
  expect_all("is locked", "lamplock operate home --board " + port_ +
                              ", or unlock it with $X in lamplock console --board " + port_);
  EXPECT_THAT(run(commands()[0]).err, HasSubstr("since power-up, as homing is on ($22)"));
  EXPECT_THAT(run(commands()[0]).err, Not(HasSubstr("alarm")));
  EXPECT_EQ(in_console("$X").status, 0);
  for (const Arguments& words : commands()) EXPECT_EQ(run(words).status, 0) << words[0];
  EXPECT_EQ(in_console("!").status, 0);
  expect_all("is held", "resume it with ~ in lamplock console --board " + port_);
  EXPECT_EQ(in_console("~").status, 0);
  for (const Arguments& words : commands()) EXPECT_EQ(run(words).status, 0) << words[0];
  EXPECT_EQ(in_console("!").status, 0);
  EXPECT_EQ(in_console(":reset").status, 0);
  EXPECT_THAT(run(commands()[1]).status, testing::AnyOf(0, 1));
  // A program may unlock by itself.
  const std::string own = folder_.write("own.ngc", "$X\nG21 G91\nG1 X1 F6000\n");
  EXPECT_EQ(run({"send", own, "--board", port_, "--yes"}).status, 0);
}

/// The journal is proved like other outputs, before the first shot.
TEST_F(BlockedBoard, JobWhoseJournalCannotBeWrittenIsRefused) {
  ASSERT_TRUE(sim_.wait_for("Ctrl-C"));
  ASSERT_EQ(in_console("$X").status, 0);
  const auto refused = [&](const std::string& journal, const Arguments& more) {
    Arguments words = commands()[0];
    words.insert(words.end(), more.begin(), more.end());
    const Finished run_of_job = run(words);
    EXPECT_EQ(run_of_job.status, 2) << journal;
    EXPECT_THAT(run_of_job.err, testing::StartsWith("error: " + journal + ": "));
    return run_of_job.err;
  };
  for (const std::string journal : {"/dev/null", "/dev/full", "/proc/a.progress"})
    refused(journal, {"--progress", journal});
  std::filesystem::create_directory(list_ + ".progress");
  const std::string of_default = refused(list_ + ".progress", {});
  EXPECT_THAT(of_default, HasSubstr(": the progress of the job is kept there, but the file is a"));
  EXPECT_THAT(of_default, HasSubstr("--progress FILE"));
}

/// Without homing ($22=0), `operate home` would be refused.
TEST_F(BlockedBoard, WithoutHomingIsOnlyUnlocked) {
  ASSERT_TRUE(sim_.wait_for("Ctrl-C"));
  ASSERT_EQ(in_console("$X").status, 0);
  ASSERT_EQ(in_console("$22=0").status, 0);
  Running moving({"console", "--board", port_}, "G1 X40 F600\n:reset\n");
  (void)moving.finish();
  for (const Arguments& words : {commands()[1], commands()[2]}) {
    const std::string err = run(words).err;
    EXPECT_THAT(err, HasSubstr("is locked"));
    EXPECT_THAT(err, HasSubstr("unlock it with $X in lamplock console --board " + port_));
    EXPECT_THAT(err, Not(HasSubstr("operate home")));
  }
  EXPECT_THAT(run({"operate", "home", "--board", port_}).err, HasSubstr("homing is switched off"));
}

/// The command of the remedy, which follows `begin` in a message.
std::string remedy_after(const std::string& err, const std::string& begin) {
  const auto at = err.find(begin);
  if (at == std::string::npos) return "";
  const auto command = at + begin.size();
  return err.substr(command, err.find(" in lamplock console") - command);
}

TEST_F(BlockedBoard, OutsideOfItsWorkSpaceIsMovedInsideByTheRemedy) {
  ASSERT_TRUE(sim_.wait_for("Ctrl-C"));
  const Finished moved = in_console("$X\n$21=0\n$20=0\nG53 G0 X-60 Y60\nG4 P0");
  ASSERT_EQ(moved.status, 0) << moved.out << moved.err;
  ASSERT_EQ(in_console("$20=1").status, 0);
  const Finished refused = run(commands()[0]);
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("outside its work space"));
  EXPECT_THAT(refused.err, Not(HasSubstr("--from")));
  ASSERT_EQ(in_console(remedy_after(refused.err, "move it inside: ") + "\nG4 P0").status, 0);
  EXPECT_EQ(run(commands()[0]).status, 0);
}

/// A setting that the job does not have is named, before the user is asked.
TEST_F(BlockedBoard, WithOtherSettingsNamesThem) {
  ASSERT_TRUE(sim_.wait_for("Ctrl-C"));
  const std::string job = folder_ / "p.llj";
  ASSERT_EQ(run({"job", list_, "-o", job, "--machine", profile_}).status, 0);
  ASSERT_EQ(in_console("$X\n$120=700").status, 0);
  const Finished refused = run({"send", job, "--board", port_, "--yes"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("acceleration_x"));
  EXPECT_THAT(refused.err, HasSubstr("lamplock settings backup board.toml --board " + port_));
}

/// `operate pulse` has no --from.
TEST_F(BlockedBoard, StoppedTestFlashesNameNoOptionOfOtherCommands) {
  ASSERT_TRUE(sim_.wait_for("Ctrl-C"));
  ASSERT_EQ(in_console("$X").status, 0);
  Running pulse({"operate", "pulse", "--flashes", "255", "--yes", "--board", port_});
  std::this_thread::sleep_for(std::chrono::milliseconds(600));
  pulse.terminate();
  const Finished stopped = pulse.finish();
  EXPECT_EQ(stopped.status, 143);
  EXPECT_THAT(stopped.err, Not(HasSubstr("--from")));
}

TEST_F(BlockedBoard, ThatIsSimulatedIsUnlocked) {
  EXPECT_EQ(run({"engrave", list_, "--machine", profile_}).status, 0);
  EXPECT_EQ(run({"send", program_, "--machine", profile_}).status, 0);
  EXPECT_EQ(run({"operate", "init", "--machine", profile_}).status, 0);
  EXPECT_EQ(run({"operate", "pulse", "--machine", profile_}).status, 0);
}

TEST(NotReady, NamesOneCauseForEachState) {
  using wire::MachineState;
  wire::StatusSummary status;
  status.state = MachineState::alarm;
  EXPECT_THAT(link::why_locked(status, "").what, HasSubstr("since power-up"));
  EXPECT_THAT(link::why_locked(status, "").remedy, Not(HasSubstr("--board")));
  status.alarm = 11;
  EXPECT_THAT(link::why_locked(status, "").what, HasSubstr("since power-up"));
  status.alarm = 3;
  EXPECT_THAT(link::why_locked(status, "p 7").what, HasSubstr("ALARM:3 reset while moving"));
  EXPECT_THAT(link::why_locked(status, "p 7").remedy, HasSubstr("--board 'p 7'"));
  status.state = MachineState::estop;
  EXPECT_EQ(link::why_locked(status, "p").what, link::why_stopped(status, "p").what);
  EXPECT_THAT(link::why_stopped(status, "p").remedy, HasSubstr("release it"));
  status.state = MachineState::door;
  EXPECT_EQ(link::why_stopped(status, "p").what, "its door is open");
  for (const char* const report :
       {"<Door:1|MPos:0,0,0>", "<Door:0|MPos:0,0,0>", "<Hold:0|MPos:0,0,0>", "<Sleep|MPos:0,0,0>"})
    EXPECT_THAT(link::why_not_ready(*link::parse_status(report), "p", link::Homing::on).remedy,
                HasSubstr("in lamplock console --board p"))
        << report;
}

}  // namespace
}  // namespace lamplock::cli::test::blocked_board
