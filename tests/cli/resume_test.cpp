// Jobs whose program is killed or whose board loses its power, continued as the program advises.
#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <memory>
#include <thread>

#include "tests/cli/inputs.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/shots.hpp"

namespace lamplock::cli::test {
namespace {

using testing::HasSubstr;

/// A job on a simulated board at a port, at the pace of the wall clock.
class Resumed : public testing::Test {
 protected:
  static constexpr int points_in_all = 900;

  void start_board(const std::string& shots) {
    board_ = std::make_unique<Running>(std::vector<std::string>{
        "sim", "--pty", folder_ / "port", "--lamp", "200", "--shots", folder_ / shots});
    ASSERT_TRUE(board_->wait_for("Ctrl-C"));
  }
  void stop_board() {
    board_->interrupt();
    EXPECT_EQ(board_->finish().status, 0);
  }
  std::vector<std::string> engrave(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"engrave",        list_,  "--lamp", "200", "--board",
                                       folder_ / "port", "--yes"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  std::size_t shots(const std::string& file) const { return read_shots(folder_ / file).size(); }

  Folder folder_;
  std::string list_ = folder_.write("p.xyz", xyz(walk(points_in_all, 4, 0.05)));
  std::string journal_ = list_ + ".progress";
  std::unique_ptr<Running> board_;
};

TEST_F(Resumed, AfterItsProgramWasKilled) {
  start_board("shots.csv");
  InTerminal killed(engrave());
  ASSERT_TRUE(killed.wait_for("engraving"));
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  killed.send_signal(SIGKILL);
  killed.finish();
  ASSERT_TRUE(std::filesystem::exists(journal_));
  const Finished repeated = run(engrave());
  EXPECT_EQ(repeated.status, 2);
  EXPECT_THAT(repeated.err, HasSubstr("no known end"));
  EXPECT_THAT(repeated.err, HasSubstr("--resume"));
  const Finished other = run(engrave({"--from", "1"}));
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err, HasSubstr("holds an unfinished job"));
  // Options that differ from the run's, and a resume without permission, change nothing.
  EXPECT_EQ(run(engrave({"--flashes", "2"})).status, 2);
  std::vector<std::string> unasked = engrave({"--resume"});
  unasked.erase(std::find(unasked.begin(), unasked.end(), "--yes"));
  InTerminal asked(unasked);
  ASSERT_TRUE(asked.wait_for("Type yes"));
  asked.type("no\n");
  EXPECT_THAT(asked.finish().out, HasSubstr("not permitted"));
  EXPECT_THAT(run(engrave()).err, HasSubstr("no known end"));
  const Finished resumed = run(engrave({"--resume"}));
  EXPECT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_THAT(resumed.out, HasSubstr("resume"));
  EXPECT_FALSE(std::filesystem::exists(journal_));
  stop_board();
  EXPECT_EQ(shots("shots.csv"), points_in_all);
}

/// Remedies name what each command has: frame has neither --resume nor --discard.
TEST_F(Resumed, OrDiscardedForAnotherCommand) {
  start_board("shots.csv");
  InTerminal killed(engrave());
  ASSERT_TRUE(killed.wait_for("engraving"));
  std::this_thread::sleep_for(std::chrono::milliseconds(800));
  killed.send_signal(SIGKILL);
  killed.finish();
  const std::string port = folder_ / "port";
  const std::vector<std::string> frame{"frame", list_, "--board", port};
  const Finished refused = run(frame);
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("continue it with --resume and its own job, or replace it: "
                                     "lamplock send FILE --discard --board " +
                                     port));
  const std::string other = folder_.write("other.xyz", xyz(walk(20, 4, 0.05)));
  EXPECT_EQ(run({"engrave", other, "--lamp", "200", "--board", port, "--yes", "--discard"}).status,
            0);
  EXPECT_EQ(run(frame).status, 0);
  stop_board();
}

TEST_F(Resumed, AfterItsBoardHasLostItsPower) {
  start_board("first.csv");
  // The board never has more points than it fires before it holds without a host.
  Running running(engrave());
  ASSERT_TRUE(running.wait_for("engraving: "));
  std::this_thread::sleep_for(std::chrono::milliseconds(1000));
  stop_board();
  start_board("second.csv");
  const Finished lost = running.finish();
  EXPECT_EQ(lost.status, 1);
  EXPECT_THAT(lost.err, HasSubstr("restarted"));
  EXPECT_THAT(lost.err, HasSubstr("at least the points before"));
  EXPECT_THAT(lost.err, HasSubstr("--resume"));
  const Finished resumed = run(engrave({"--resume"}));
  EXPECT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_THAT(resumed.out, HasSubstr("may have been fired"));
  stop_board();
  std::size_t doubtful = 0;
  for (const std::string& name : folder_.files())
    if (name.find("doubtful") != std::string::npos) doubtful += lines(read(folder_ / name)).size();
  const std::size_t fired = shots("first.csv") + shots("second.csv");
  EXPECT_LE(fired, static_cast<std::size_t>(points_in_all));
  EXPECT_GE(fired + doubtful, static_cast<std::size_t>(points_in_all));
  EXPECT_GT(shots("second.csv"), 50u);
}

TEST_F(Resumed, OnlyTheSameJobThatWasBegun) {
  start_board("shots.csv");
  const Finished nothing = run(engrave({"--resume"}));
  EXPECT_EQ(nothing.status, 2);
  EXPECT_THAT(nothing.err, HasSubstr("contains no run"));
  EXPECT_THAT(nothing.err, HasSubstr("continue with --from N")) << "a journal may have been lost";
  folder_.write("p.xyz.progress", "# torn\nbegun 0000");
  EXPECT_EQ(run(engrave({"--resume"})).status, 2);
  for (const std::vector<std::string>& wrong :
       {std::vector<std::string>{"--resume", "--from", "3"}, {"--resume", "--dry"}})
    EXPECT_EQ(run(engrave(wrong)).status, 2);
  EXPECT_EQ(run({"engrave", list_, "--resume"}).status, 2)
      << "a board simulated in the program cannot resume";
  stop_board();
}

TEST_F(Resumed, ANewStartAfterAStopIsSaid) {
  start_board("shots.csv");
  Running stopped(engrave());
  ASSERT_TRUE(stopped.wait_for("of 900"));
  stopped.terminate();
  stopped.finish();
  Running again(engrave());
  EXPECT_TRUE(again.wait_for("this one begins at point 0 again"));
  again.terminate();
  again.finish();
  stop_board();
}

/// The program does not look as if it engraved.
TEST_F(Resumed, ALostLinkIsSaidAtOnce) {
  start_board("shots.csv");
  Running sending(engrave());
  ASSERT_TRUE(sending.wait_for("of 900"));
  board_.reset();  // kills it
  EXPECT_TRUE(sending.wait_for("the board does not answer"));
}

}  // namespace
}  // namespace lamplock::cli::test
