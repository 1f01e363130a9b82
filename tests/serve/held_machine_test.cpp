// A machine that is held in an earlier program, files that change after their check, positions in
// inches.
#include <gmock/gmock.h>

#include <chrono>
#include <cmath>
#include <string>
#include <thread>

#include "tests/serve/running_server.hpp"

namespace lamplock::serve::test {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using testing::HasSubstr;

/// Only a paired client continues what may have the laser on, also if another one starts a dry run.
TEST(HeldMachine, is_not_resumed_by_a_dry_run_of_an_unpaired_client) {
  RunningServer server({.is_simulated = false});
  server.add_file("dry.ngc", "G21G91\nG1X1F3000\n");
  {
    RawClient paired = server.controller();
    EXPECT_EQ(error_of(paired.call("pair", {{"code", pairing_code}})), "");
    EXPECT_EQ(error_of(paired.call("console.send", {{"line", "G21G91M3S500G1X40F300"}})), "");
    ASSERT_TRUE(server.wait_for_state("Run"));
    paired.call("machine.hold");
    ASSERT_TRUE(server.wait_for_state("Hold"));
    paired.call("control.release");
  }
  RawClient other = server.client("other");
  other.call("control.take");
  const json dry{{"name", "dry.ngc"}, {"dry", true}};
  EXPECT_THAT(error_of(other.call("machine.resume")), HasSubstr("may not fire"));
  other.call("machine.zero", {{"axes", "X"}});
  EXPECT_THAT(error_of(other.call("job.start", dry)), HasSubstr("is held in an earlier program"));
  EXPECT_THAT(error_of(other.call("machine.resume")), HasSubstr("may not fire"));
  std::this_thread::sleep_for(300ms);
  EXPECT_TRUE(server.machine().view().board.state.starts_with("Hold"));
  other.call("machine.stop");
  EXPECT_TRUE(server.wait_for_state("Idle"));
  EXPECT_EQ(error_of(other.call("job.start", dry)), "");
  EXPECT_EQ(server.wait_for_end(), "done");
}

TEST(CheckedFile, does_not_run_after_it_was_replaced) {
  RunningServer server;
  server.add_file("part.ngc", "G21G91\nG1X1F3000\n");
  RawClient client = server.controller();
  const json revision = client.call("job.check", {{"name", "part.ngc"}})["result"]["revision"];
  const json start{{"name", "part.ngc"}, {"revision", revision}};
  EXPECT_EQ(error_of(client.call("job.start", start)), "");
  EXPECT_EQ(server.wait_for_end(), "done");
  server.add_file("part.ngc", "G21G91\nG1X2F3000\n");
  EXPECT_THAT(error_of(client.call("job.start", start)), HasSubstr("check it again"));
  EXPECT_EQ(error_of(client.call("job.start", {{"name", "part.ngc"}})), "");
  EXPECT_EQ(server.wait_for_end(), "done");
}

TEST(Positions, are_in_mm_of_a_machine_that_reports_inches) {
  RunningServer server;
  RawClient client = server.controller();
  client.call("console.send", {{"line", "G21G90G0X5"}});
  const auto is_at = [&](double x) {
    return comes_true([&] {
      const BoardView board = server.machine().view().board;
      return board.state == "Idle" && std::abs(board.machine_mm.at(0) - x) < 0.01;
    });
  };
  ASSERT_TRUE(is_at(5));
  EXPECT_EQ(error_of(client.call("settings.set", {{"changes", {{"report_inches", 1}}}})), "");
  std::this_thread::sleep_for(500ms);  // some reports
  EXPECT_TRUE(is_at(5));
}

}  // namespace
}  // namespace lamplock::serve::test
