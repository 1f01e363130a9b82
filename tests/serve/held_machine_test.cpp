// A machine that is held in an earlier program, jogs at limits, files that change after their
// check, positions in inches.
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
  EXPECT_THAT(error_of(other.call("job.start", dry)), HasSubstr("the machine is held; resume it"));
  EXPECT_THAT(error_of(other.call("machine.resume")), HasSubstr("may not fire"));
  std::this_thread::sleep_for(300ms);
  EXPECT_TRUE(server.machine().view().board.state.starts_with("Hold"));
  other.call("machine.stop");
  EXPECT_TRUE(server.wait_for_state("Idle"));
  EXPECT_EQ(error_of(other.call("job.start", dry)), "");
  EXPECT_EQ(server.wait_for_end(), "done");
}

/// The board would execute them after the held program, at another place.
TEST(HeldMachine, refuses_lines_jogs_and_settings) {
  RunningServer server;
  RawClient client = server.controller();
  EXPECT_EQ(error_of(client.call("console.send", {{"line", "G21G91G1X40F300"}})), "");
  ASSERT_TRUE(server.wait_for_state("Run"));
  client.call("machine.hold");
  ASSERT_TRUE(server.wait_for_state("Hold"));
  const json jog{{"direction", {1, 0, 0}}, {"feed", 600}, {"seen", now_us() / 1000}};
  const json step{{"axis", 0}, {"mm", 1}, {"feed", 600}};
  const std::vector<std::pair<const char*, json>> requests{{"machine.zero", {{"axes", "X"}}},
                                                           {"machine.home", json::object()},
                                                           {"console.send", {{"line", "G0X3"}}},
                                                           {"settings.get", json::object()},
                                                           {"jog.run", jog},
                                                           {"jog.step", step}};
  for (const auto& [method, parameters] : requests)
    EXPECT_THAT(error_of(client.call(method, parameters)),
                HasSubstr("the machine is held; resume it"))
        << method;
  client.call("machine.stop");
  ASSERT_TRUE(server.wait_for_state("Idle"));
  EXPECT_EQ(error_of(client.call("machine.zero", {{"axes", "X"}})), "");
}

TEST(Jogs, are_refused_in_an_alarm) {
  RunningServer server;
  RawClient client = server.controller();
  EXPECT_EQ(error_of(client.call("settings.set", {{"changes", {{"soft_limits", 1}}}})), "");
  EXPECT_EQ(error_of(client.call("console.send", {{"line", "G21G90G0X4000"}})), "");
  ASSERT_TRUE(server.wait_for_state("Alarm"));
  const json step{{"axis", 0}, {"mm", 1}, {"feed", 600}};
  EXPECT_THAT(error_of(client.call("jog.step", step)), HasSubstr("the machine is in alarm"));
  EXPECT_EQ(error_of(client.call("machine.unlock")), "");
  ASSERT_TRUE(server.wait_for_state("Idle"));
  EXPECT_EQ(error_of(client.call("jog.step", step)), "");
}

/// A key that is held near the end of the travel moves the machine there, however fast.
TEST(Jogs, reach_the_end_of_the_travel) {
  RunningServer server;
  RawClient client = server.controller();
  EXPECT_EQ(error_of(client.call("settings.set", {{"changes", {{"soft_limits", 1}}}})), "");
  EXPECT_EQ(error_of(client.call("console.send", {{"line", "G21G90G0X45"}})), "");
  ASSERT_TRUE(comes_true([&] {
    const auto at = server.machine().view().board.machine_mm;
    return !at.empty() && std::abs(at[0] - 45) < 0.001;
  }));
  ASSERT_TRUE(server.wait_for_state("Idle"));
  for (int i = 0; i < 10; ++i, std::this_thread::sleep_for(70ms)) {
    const json jog{{"direction", {1, 0, 0}}, {"feed", 6000}, {"seen", now_us() / 1000}};
    EXPECT_EQ(error_of(client.call("jog.run", jog)), "");
  }
  EXPECT_GT(server.machine().view().board.machine_mm.at(0), 48.9) << "the travel ends at 50";
  const std::string lines = client.call("console.lines")["result"].dump();
  EXPECT_EQ(lines.find("error:15"), lines.rfind("error:15")) << "it is printed once";
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
